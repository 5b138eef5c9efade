// The meshes and rays of `claray verify`, for the other tests.
#pragma once

#include <cmath>

#include "host/verify/shapes.hpp"

namespace claray::test {

using verify::grid;
using verify::make_ray;
using verify::Random;
using verify::random_rays;
using verify::soup;
using verify::sphere;

/// Large triangles among small ones: Builder::high splits them.
inline Mesh ball_with_dust() {
    Mesh mesh = sphere(0);
    const Mesh dust = soup(1500, 0.02f, 4);
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), dust.positions.begin(), dust.positions.end());
    for (const glm::uvec3& t : dust.triangles) mesh.triangles.push_back(t + first);
    return mesh;
}

/// Rays through the pixels of a pinhole at `eye` that looks at `target`, row by row.
inline std::vector<Ray> camera_rays(glm::vec3 eye, glm::vec3 target, unsigned width, unsigned height,
                                    float spread = 0.8f) {
    const glm::vec3 forward = glm::normalize(target - eye);
    const glm::vec3 side =
        std::fabs(forward.y) < 0.9f ? glm::cross(forward, glm::vec3(0, 1, 0)) : glm::vec3(1.f, 0.f, 0.f);
    const glm::vec3 right = glm::normalize(side), up = glm::cross(right, forward);
    std::vector<Ray> rays;
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x) {
            const float u = (float(x) + 0.5f) / float(width) * 2 - 1, v = 1 - (float(y) + 0.5f) / float(height) * 2;
            rays.push_back(make_ray(eye, forward + spread * (u * right + v * up)));
        }
    return rays;
}

}  // namespace claray::test
