// Splits the triangles of a scene into parts by space.
#pragma once

#include <cstdint>
#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// Consecutive meshes that one bottom level holds, or a scene without instances as a whole.
struct SceneObject {
    std::size_t first_mesh = 0, meshes = 0;
    std::uint32_t first_triangle = 0, first_vertex = 0, triangles = 0;  // counted through the scene
};
/// `baked` as in PlacedScene: the first meshes are one object.
[[nodiscard]] std::vector<SceneObject> objects_of(const Scene& scene, std::size_t baked);

/// Triangles of an object, by their numbers in it, in ascending order.
struct ObjectPiece {
    std::size_t object = 0;
    std::vector<std::uint32_t> triangles;
};
/// At least `parts` parts of about equal numbers of triangles, as far as there are so many triangles. Large objects are
/// cut at the median of their longest axis; small ones share a part in their order.
[[nodiscard]] std::vector<std::vector<ObjectPiece>> split_scene(const Scene& scene,
                                                                const std::vector<SceneObject>& objects,
                                                                unsigned parts);

}  // namespace claray
