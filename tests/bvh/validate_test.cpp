// The validation finds errors: bvh/validate.cl.
#include <gtest/gtest.h>

#include <cmath>

#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

TEST(Bvh, ValidationFindsWhatIsBroken) {
    const Mesh mesh = soup(500, 0.05f, 11);
    const auto broken = [&](auto&& damage) {
        const Bvh bvh = build(mesh);
        Buffer<BvhNode> nodes = state_of(bvh).nodes;
        Buffer<LeafTriangle> leaves = state_of(bvh).leaves;
        std::vector<BvhNode> host_nodes = nodes.read();
        std::vector<LeafTriangle> host_leaves = leaves.read();
        damage(host_nodes, host_leaves);
        nodes.write(host_nodes);
        leaves.write(host_leaves);
        return bvh.validate();
    };
    EXPECT_TRUE(broken([](auto&, auto&) {}).ok());
    EXPECT_GT(broken([](auto& n, auto&) { n[100].hi0x = std::nextafter(n[100].hi0x, -infinity); }).boxes_not_containing,
              0u);
    EXPECT_GT(broken([](auto& n, auto&) { n[100].lo1z = nan; }).boxes_not_containing, 0u);
    EXPECT_GT(broken([](auto& n, auto&) { n[100].parent ^= 1; }).links_broken, 0u);
    EXPECT_GT(broken([](auto& n, auto&) { n[100].child0 = 499; }).links_broken, 0u);
    const BvhValidation twice = broken([](auto&, auto& l) { l[7].primitive = l[8].primitive; });
    EXPECT_EQ(twice.leaves_missing, 1u);
    EXPECT_EQ(twice.leaves_repeated, 1u);
}

}  // namespace
}  // namespace claray::test
