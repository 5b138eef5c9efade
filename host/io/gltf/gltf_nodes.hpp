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

/// The scene that is chosen; empty: the default one, else the first. Null where the file has none.
[[nodiscard]] const tinygltf::Scene* chosen_scene(const GltfFile& file, const std::string& choice);

/// All nodes of a scene (null: all nodes that are no one's child), parents first, in the order of the file. Throws
/// where nodes form no trees.
[[nodiscard]] std::vector<PlacedNode> place_nodes(const GltfFile& file, const tinygltf::Scene* scene);

[[nodiscard]] inline glm::vec3 position_of(const PlacedNode& node) { return glm::vec3(node.world[3]); }

/// An axis of the node in the world, of unit length. It looks along -z, with +y up (section 3.10.2).
[[nodiscard]] glm::vec3 axis_of(const PlacedNode& node, int axis, const GltfFile& file);

/// Where the nodes of all scenes and of none stand, by their numbers. Nothing for those that are below themselves.
using NodeTransforms = std::vector<std::optional<glm::dmat4>>;
[[nodiscard]] NodeTransforms all_transforms(const GltfFile& file);

}  // namespace claray
