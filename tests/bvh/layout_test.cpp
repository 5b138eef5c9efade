// Leaves of several triangles, by every builder.
#include <gtest/gtest.h>

#include <algorithm>

#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

class Leaves : public testing::TestWithParam<std::tuple<Builder, unsigned>> {
protected:
    static Bvh with_limit(const Mesh& mesh, unsigned limit) {
        return Bvh::build(device(), std::span(&mesh, 1),
                          {.builder = std::get<0>(GetParam()), .layout = Layout::binary, .max_leaf_triangles = limit});
    }
};

/// Triangles of each leaf, from left to right.
std::vector<std::uint32_t> leaf_sizes(const Bvh& bvh) {
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    std::vector<std::uint32_t> sizes, stack;
    if (const std::uint32_t root = state_of(bvh).read_header().root; root != CLARAY_NO_CHILD) stack.push_back(root);
    while (!stack.empty()) {
        const std::uint32_t child = stack.back();
        stack.pop_back();
        if (child & CLARAY_LEAF)
            sizes.push_back(CLARAY_LEAF_COUNT(child));
        else
            stack.insert(stack.end(), {nodes[child].child1, nodes[child].child0});
    }
    return sizes;
}

/// A grid of squares, two triangles each, in the order of its rows, with small triangles scattered round it.
Mesh squares_and_soup(std::size_t count) {
    Mesh mesh = soup(count, 0.02f, 6);
    const Mesh squares = grid(20);
    const auto base = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), squares.positions.begin(), squares.positions.end());
    for (const glm::uvec3& triangle : squares.triangles) mesh.triangles.push_back(triangle + base);
    return mesh;
}

/// Stacks of six equal triangles, and others with a spike between any two of them. All centroids of a stack are the
/// same, so that codes are, and leaves keep this order.
Mesh stacks(std::size_t count) {
    Mesh mesh;
    const auto add = [&](glm::vec3 center, glm::vec3 half) {
        const auto base = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(),
                              {center + half * glm::vec3(-1, -1, -1), center + half * glm::vec3(1, -1, -1),
                               center + half * glm::vec3(0, 1, 1)});
        mesh.triangles.emplace_back(base, base + 1, base + 2);
    };
    for (std::size_t stack = 0; stack < count; ++stack) {
        const glm::vec3 center = 4.f * glm::vec3(float(stack % 8), float(stack / 8 % 8), float(stack / 64));
        for (int i = 0; i < 6; ++i) {
            add(center, glm::vec3(1.f, 1.f, 1.f / 64));
            if (stack % 2 == 0) add(center, glm::vec3(1.f / 64, 1.f / 64, 1.f));
        }
    }
    return mesh;
}

TEST_P(Leaves, OfStacksAreLargeAndWithoutWhatLiesBetween) {
    const Bvh bvh = with_limit(stacks(96), std::get<1>(GetParam()));
    expect_valid(bvh);
    const std::vector<std::uint32_t> sizes = leaf_sizes(bvh);
    const std::uint32_t most = *std::max_element(sizes.begin(), sizes.end());
    EXPECT_LE(most, std::get<1>(GetParam()));
    EXPECT_GT(most, std::get<1>(GetParam()) / 2);  // pairs of leaves are joined, halves are made
}

TEST_P(Leaves, HoldTheSameTrianglesAndNoMoreThanTheLimit) {
    const unsigned limit = std::get<1>(GetParam());
    for (const std::size_t count : {0u, 1u, 2u, 3u, 5u, 9u, 1000u}) {
        SCOPED_TRACE(testing::Message() << count);
        const Mesh mesh = count < 10 ? soup(count, 0.3f, unsigned(count)) : squares_and_soup(count);
        Bvh bvh = with_limit(mesh, limit);
        expect_valid(bvh);
        const std::vector<std::uint32_t> sizes = leaf_sizes(bvh);
        const std::uint32_t most = sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end());
        EXPECT_LE(most, limit);
        if (count == 1000) {
            EXPECT_GT(most, 1u);
        }
        EXPECT_LE(bvh.statistics().sah_cost, 1.00001 * with_limit(mesh, 1).statistics().sah_cost);

        const std::vector<Ray> rays = random_rays(3001, 4.f, 1.f, 5);
        const std::vector<Hit> expected = closest_hit(bvh, rays, brute_force);
        for (const bool refitted : {false, true}) {
            if (refitted) bvh.refit();
            if (refitted) expect_valid(bvh);
            const std::vector<Hit> hits = closest_hit(bvh, rays);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                ASSERT_EQ(hits[i].primitive, expected[i].primitive) << "ray " << i;
                ASSERT_EQ(hits[i].t, expected[i].t);
            }
        }
    }
}

/// Two triangles of one square are better off together, whatever builder joins them.
TEST_P(Leaves, OfOneAreNotWhatASquareGets) {
    const Bvh bvh = with_limit(grid(64), std::get<1>(GetParam()));
    const std::vector<std::uint32_t> sizes = leaf_sizes(bvh);
    const auto singles = std::size_t(std::count(sizes.begin(), sizes.end(), 1u));
    EXPECT_LT(5 * singles, bvh.triangle_count());
}

TEST_P(Leaves, AreTheSameAfterARebuild) {
    const Mesh mesh = squares_and_soup(4000);
    Bvh bvh = with_limit(mesh, std::get<1>(GetParam()));
    const std::string hash = bvh.hash();
    bvh.rebuild();
    EXPECT_EQ(bvh.hash(), hash);
}

INSTANTIATE_TEST_SUITE_P(Builders, Leaves,
                         testing::Combine(testing::Values(Builder::fast, Builder::balanced, Builder::high),
                                          testing::Values(2u, 3u, 4u)));

}  // namespace
}  // namespace claray::test
