// Instances made ready for rendering: those that need not be instances become part of the world.
#pragma once

#include "claray/scene.hpp"
#include "claray/shared/types.h"

namespace claray {

/// Which triangles of a scene those of another are, that has its meshes in another order.
class TriangleNumbers {
public:
    /// The next mesh, of so many triangles, whose first one has the number `first` there.
    void add(std::uint32_t first, std::size_t triangles);
    [[nodiscard]] bool empty() const { return there_.empty(); }
    /// CLARAY_MISS stays.
    [[nodiscard]] std::uint32_t number_there(std::uint32_t triangle) const;

private:
    std::vector<std::uint32_t> here_, there_;  // of the first triangle of each mesh
    std::uint32_t next_ = 0;
};

/// A scene of the same look, whose instances are those that have to be.
struct PlacedScene {
    /// Its first `baked` meshes lie in the world, each once, by an instance that does nothing; then come those that the
    /// other instances share. Without any of these there are no instances at all.
    Scene scene;
    std::size_t baked = 0;
    TriangleNumbers numbers;  ///< in the given scene
};

/// Bakes an instance's transform into its mesh where the mesh has no other, nothing moves, and float32 carries it: no
/// triangle is to be bent by the rounding of its corners by more than a thousandth, unless it is in its own mesh. One
/// tree over all of the world is cheaper to traverse than one of trees. Instances of empty meshes are left out.
[[nodiscard]] PlacedScene place_instances(const Scene& scene);

/// The mesh in the world. A mirrored one's triangles turn the other way round, so that their fronts stay fronts.
[[nodiscard]] Mesh transformed(const Mesh& mesh, const glm::mat4& transform);

/// Whether it is somewhere else when the shutter closes.
[[nodiscard]] inline bool moves(const MeshInstance& instance) {
    return instance.transform_end.value_or(instance.transform) != instance.transform;
}

}  // namespace claray
