// glTF primitives to meshes.
#pragma once

#include <array>
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

/// The numbers N of the TEXCOORD_N that become Mesh::uvs and Mesh::uvs1.
using GltfUvSets = std::array<int, 2>;

/// What the triangles of a primitive wear.
struct GltfLook {
    std::uint32_t material = 0;  ///< of the scene
    GltfUvSets uv_sets{0, 1};
    bool tangents = false;  ///< something looks at them
};

/// One primitive in a pose; nothing where it holds no triangle. Points and lines become triangles that are Strokes.
[[nodiscard]] std::optional<Mesh> read_primitive(const GltfFile& file, std::size_t mesh, std::size_t primitive,
                                                 const GltfLook& look, const GltfPose& pose, GltfLeftOut& left_out);

/// Whether it is of points or lines.
[[nodiscard]] bool is_strokes(const tinygltf::Primitive& primitive);

/// The mesh as it stands in the world. A transform that mirrors turns the triangles round, so that their fronts stay
/// fronts (glTF 2.0, section 3.7.4).
[[nodiscard]] Mesh transformed(Mesh mesh, const glm::dmat4& transform);

}  // namespace claray
