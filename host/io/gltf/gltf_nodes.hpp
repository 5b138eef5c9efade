// The nodes of a glTF's scene, and where they stand.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

/// A node of the scene, where it stands in the world.
struct PlacedNode {
    const tinygltf::Node* node = nullptr;
    std::string name;
    glm::dmat4 world{1.0};
    bool visible = true;  ///< it and all above it (KHR_node_visibility); cameras do not care
};

/// Translation, rotation (x, y, z, w; of any length but 0) and scale, in the order of section 3.5.3.
[[nodiscard]] glm::dmat4 transform_of(const glm::dvec3& translation, const glm::dvec4& rotation,
                                      const glm::dvec3& scale);

/// All nodes of the scene that is chosen (empty: the default one, else the first, else all nodes that are no one's
/// child), parents first, in the order of the file. Throws where nodes form no trees.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const GltfFile& file, const std::string& scene);

/// Where the nodes of all scenes and of none stand, by their numbers. Nothing for those that are below themselves.
using NodeTransforms = std::vector<std::optional<glm::dmat4>>;
[[nodiscard]] NodeTransforms all_transforms(const GltfFile& file);

}  // namespace claray
