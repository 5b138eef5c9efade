// The meshes and rays of `claray verify`, for the other tests.
#pragma once

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

}  // namespace claray::test
