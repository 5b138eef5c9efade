// From a scene of Assimp to glTF.
#pragma once

#include <assimp/scene.h>
#include <map>
#include <string>

#include "host/io/assimp/child/glb.hpp"
#include "host/io/assimp/child/scene_folder.hpp"

namespace claray::assimp {

/// What a glTF does not take from the scene, and how often: "bump maps".
using LeftOut = std::map<std::string, std::size_t>;

/// Adds all materials, in Assimp's order, with their textures.
void add_materials(Glb& glb, const aiScene& scene, const SceneFolder& folder, LeftOut& left_out);

/// Adds the meshes that nodes show, skins, cameras, lights, animations and all nodes, below one that turns the unit of
/// FBX into metres.
void add_nodes(Glb& glb, const aiScene& scene, LeftOut& left_out);

/// The primitive of a glTF for a mesh of Assimp, with its joints and weights; null if it has nothing to show.
[[nodiscard]] Json primitive_of(Glb& glb, const aiMesh& mesh, bool with_joints, LeftOut& left_out);

/// Animations of nodes, whose indices are given by name.
void add_animations(Glb& glb, const aiScene& scene, const std::map<std::string, std::size_t>& nodes, LeftOut& left_out);

/// Cameras and lights, as children of the nodes of their names. `metres`: in a unit of the scene.
void add_cameras_and_lights(Glb& glb, const aiScene& scene, const std::map<std::string, std::size_t>& nodes,
                            double metres, LeftOut& left_out);

}  // namespace claray::assimp
