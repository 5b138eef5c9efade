// Instances for tests: transforms of all kinds, and bottom levels.
#pragma once

#include "host/verify/placements.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {

/// The structure of each mesh.
std::vector<Bvh> build_bottoms(std::span<const Mesh> meshes, Layout layout);

using verify::moved;
using verify::random_instances;
using verify::random_rotation;

bool same(const InstanceHit& a, const InstanceHit& b);

}  // namespace claray::test
