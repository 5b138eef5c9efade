// glTF primitives to meshes.
#pragma once

#include <optional>

#include "host/io/gltf/gltf_skin.hpp"

namespace claray {

/// What was left out of the meshes, for one warning each.
struct GltfLeftOut {
    std::size_t without_positions = 0, with_clamped_colors = 0;
};

/// What bends a mesh, in this order.
struct GltfPose {
    std::vector<double> weights;          ///< of its morph targets; missing ones are 0
    std::optional<JointMatrices> joints;  ///< of its skin
};

/// One primitive in a pose, all of whose triangles are of `material`; nothing where it holds none. Points and lines
/// become triangles that are Strokes. Tangents are read where `tangents` says that something looks at them.
[[nodiscard]] std::optional<Mesh> read_primitive(const GltfFile& file, std::size_t mesh, std::size_t primitive,
                                                 std::uint32_t material, bool tangents, const GltfPose& pose,
                                                 GltfLeftOut& left_out);

/// Whether it is of points or lines.
[[nodiscard]] bool is_strokes(const tinygltf::Primitive& primitive);

/// The mesh as it stands in the world. A transform that mirrors turns the triangles round, so that their fronts stay
/// fronts (glTF 2.0, section 3.7.4).
[[nodiscard]] Mesh transformed(Mesh mesh, const glm::dmat4& transform);

}  // namespace claray
