// Skins of a glTF: meshes that follow the joints of a skeleton.
#pragma once

#include "host/io/gltf/gltf_nodes.hpp"

namespace claray {

/// Of each joint, from where the mesh is at rest to the world.
using JointMatrices = std::vector<glm::dmat4>;

/// `nodes`: where they all stand. Throws where the skin refers to what is not there.
[[nodiscard]] JointMatrices read_skin(const GltfFile& file, std::size_t skin, const NodeTransforms& nodes);

/// Of one set, an element a vertex: joints by number, and how much each counts.
struct JointSet {
    std::vector<glm::vec4> joints, weights;
};

/// Moves positions, normals and tangents of the mesh into the world (section 3.7.3.3); weights are made to add up to 1.
/// A vertex without any weight stays where it is. Triangles that this mirrors are turned round. `name` is the
/// primitive's.
void follow_joints(Mesh& mesh, const std::vector<JointSet>& sets, const JointMatrices& matrices, const GltfFile& file,
                   const std::string& name);

}  // namespace claray
