#include "tests/bvh/support.hpp"

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

}  // namespace claray::test
