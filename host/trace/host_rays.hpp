// Rays traced by the host before any kernel is compiled. Slower than any device and not watertight: suitable for
// statistics of many rays, not for images.
#pragma once

#include <optional>
#include <vector>

#include "claray/scene.hpp"
#include "host/bvh/host_tree.hpp"

namespace claray {

/// The nearest triangle on a ray, at shutter open.
struct HostHit {
    double distance = 0;                   ///< in lengths of the ray's direction
    std::uint32_t mesh = 0, triangle = 0;  ///< of the scene's meshes, of that mesh's triangles
    double u = 0, v = 0;                   ///< weights of the second and the third vertex
    glm::dvec3 normal{0.0};                ///< of the front, unit length
};

class HostRays {
public:
    /// Keeps a reference to the scene, which must be valid (see `validate`).
    explicit HostRays(const Scene& scene);

    /// The nearest hit closer than `distance`.
    [[nodiscard]] std::optional<HostHit> closest(const glm::dvec3& origin, const glm::dvec3& direction,
                                                 double distance) const;

private:
    struct Placed {
        std::uint32_t mesh = 0;
        glm::dmat4 to_world{1.0}, to_object{1.0};
    };
    void place(const MeshInstance& instance, Mesh& boxes);

    const Scene& scene_;
    std::vector<std::uint32_t> first_triangles_;  // of each mesh, if one tree holds all
    std::vector<HostTree> bottoms_;               // one over all meshes, or one per mesh if there are instances
    std::vector<Placed> placed_;
    HostTree top_;  // over the boxes of `placed_`
};

}  // namespace claray
