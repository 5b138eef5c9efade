// Prepares instances for rendering: those that need not be instances become part of the world.
#pragma once

#include "claray/scene.hpp"
#include "claray/shared/types.h"

namespace claray {

/// Maps triangles of one scene to those of another scene with the same meshes in another order.
class TriangleNumbers {
public:
    /// Adds the next mesh, with this many triangles; its first triangle has the number `first` in the other scene.
    void add(std::uint32_t first, std::size_t triangles);
    [[nodiscard]] bool empty() const { return there_.empty(); }
    /// CLARAY_MISS is kept, and so are the numbers of primitives, which follow the triangles.
    [[nodiscard]] std::uint32_t number_there(std::uint32_t triangle) const;
    /// The mesh of a triangle here, in the order of `add`; CLARAY_MISS for numbers of primitives.
    [[nodiscard]] std::uint32_t mesh_of(std::uint32_t triangle) const;

private:
    std::vector<std::uint32_t> here_, there_;  // of the first triangle of each mesh
    std::uint32_t next_ = 0;
};

/// Where an instance of the given scene is in the placed scene.
struct InstancePlace {
    bool baked = false;
    std::uint32_t index = CLARAY_MISS;  ///< of a mesh if it is baked, else of an instance; CLARAY_MISS: left out
};

/// An equivalent scene with only the necessary instances.
struct PlacedScene {
    /// Its first `baked` meshes are in the world, each with an identity instance; then follow the meshes of the other
    /// instances. If there are no such meshes, there are no instances at all.
    Scene scene;
    std::size_t baked = 0;
    TriangleNumbers numbers;            ///< in the given scene
    std::vector<InstancePlace> places;  ///< of the given scene's instances
};

/// Bakes an instance's transform into its mesh if the mesh has no other instance, nothing moves, and float32 is
/// accurate enough: rounding must not bend a triangle by more than a thousandth, unless it is bent in its own mesh
/// already. One tree over the world is cheaper to traverse than a tree of trees. Instances of empty meshes are left
/// out.
[[nodiscard]] PlacedScene place_instances(const Scene& scene);

/// Returns whether float32 is accurate enough for this transform to be baked.
[[nodiscard]] bool survives_baking(const Mesh& mesh, const glm::mat4& transform);
/// The mesh in world space. A mirrored mesh gets the opposite winding, so that front sides stay front sides.
[[nodiscard]] Mesh transformed(const Mesh& mesh, const glm::mat4& transform);

/// Returns whether it moves until the shutter closes.
[[nodiscard]] inline bool moves(const MeshInstance& instance) {
    return instance.transform_end.value_or(instance.transform) != instance.transform;
}

}  // namespace claray
