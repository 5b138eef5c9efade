#include "tests/bvh/support.hpp"

#include <cmath>

#include "host/bvh/bvh_state.hpp"
#include "tests/support/device.hpp"

namespace claray::test {

Bvh build(const Mesh& mesh, unsigned bits, Layout layout, Builder builder) {
    return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .morton_bits = bits, .layout = layout});
}

void expect_valid(const Bvh& bvh) {
    const BvhValidation v = bvh.validate();
    EXPECT_EQ(v.leaves_missing, 0u);
    EXPECT_EQ(v.leaves_repeated, 0u);
    EXPECT_EQ(v.boxes_not_containing, 0u);
    EXPECT_EQ(v.links_broken, 0u);
}

void expect_bounds(const Bvh& bvh, const Mesh& mesh) {
    if (mesh.triangles.empty()) return;
    const BvhHeader header = state_of(bvh).read_header();
    const Bounds bounds = bounds_of(mesh);
    EXPECT_EQ(glm::vec3(header.lox, header.loy, header.loz), bounds.lo);
    EXPECT_EQ(glm::vec3(header.hix, header.hiy, header.hiz), bounds.hi);
}

Mesh doubling_triangles() {
    Mesh mesh;
    for (std::uint32_t i = 0; i < 400; ++i) {
        const float s = std::exp2(float(i % 100) - 50.f) * (1 + float(i) * 1e-4f);
        mesh.positions.insert(mesh.positions.end(), {{s, 0, 0}, {0, s, 0}, {0, 0, s}});
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

}  // namespace claray::test
