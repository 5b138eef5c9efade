#include "tests/support/instances.hpp"

#include "tests/support/device.hpp"

namespace claray::test {

std::vector<Bvh> build_bottoms(std::span<const Mesh> meshes, Layout layout) {
    std::vector<Bvh> bottoms;
    for (const Mesh& mesh : meshes) bottoms.push_back(Bvh::build(device(), std::span(&mesh, 1), {.layout = layout}));
    return bottoms;
}

bool same(const InstanceHit& a, const InstanceHit& b) {
    return a.t == b.t && a.u == b.u && a.v == b.v && a.primitive == b.primitive && a.geometry == b.geometry &&
           a.instance == b.instance;
}

}  // namespace claray::test
