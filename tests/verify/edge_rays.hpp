// Rays at edges and vertices, as exactly as float32 allows.
#pragma once

#include "tests/support/meshes.hpp"

namespace claray::test {

inline std::vector<glm::dvec3> corners_of(const Mesh& mesh) {
    std::vector<glm::dvec3> corners;
    for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) corners.emplace_back(mesh.positions[t[k]]);
    return corners;
}

/// Rays from around `eye` that aim at random points of edges, every second one at a vertex. Three corners a triangle.
inline std::vector<Ray> rays_at_edges(const std::vector<glm::dvec3>& corners, glm::vec3 eye, float spread,
                                      std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t t = 3 * random.below(std::uint32_t(corners.size() / 3));
        const double s = i % 2 ? random.uniform() : 0.f;
        const glm::vec3 target(corners[t] + s * (corners[t + 1] - corners[t]));
        const glm::vec3 origin = eye + random.in_cube(spread);
        rays.push_back(make_ray(origin, target - origin));
    }
    return rays;
}

}  // namespace claray::test
