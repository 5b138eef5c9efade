// The wide tree: bvh/collapse.cl.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

struct WideCheck {
    std::multiset<std::uint32_t> primitives;
    std::size_t nodes = 0, blocks = 0;
};

void walk_wide(const std::vector<WideNode>& nodes, const std::vector<TriangleBlock>& blocks, std::uint32_t index,
               const Bounds& outer, WideCheck& check) {
    ++check.nodes;
    const WideNode& n = nodes[index];
    for (int i = 0; i < CLARAY_WIDTH; ++i) {
        if (n.child[i] == CLARAY_NO_CHILD) {
            EXPECT_GT(n.lox[i], n.hix[i]);
            continue;
        }
        const Bounds box{{n.lox[i], n.loy[i], n.loz[i]}, {n.hix[i], n.hiy[i], n.hiz[i]}};
        EXPECT_TRUE(glm::all(glm::lessThanEqual(outer.lo, box.lo)) && glm::all(glm::lessThanEqual(box.hi, outer.hi)));
        if (!(n.child[i] & CLARAY_LEAF)) {
            walk_wide(nodes, blocks, n.child[i], box, check);
            continue;
        }
        ++check.blocks;
        const TriangleBlock& block = blocks[n.child[i] & CLARAY_SLOT];
        const unsigned count = CLARAY_LEAF_COUNT(n.child[i]);
        for (unsigned lane = 0; lane < count; ++lane) {
            check.primitives.insert(block.primitive[lane]);
            for (const glm::vec3 v : {glm::vec3(block.v0x[lane], block.v0y[lane], block.v0z[lane]),
                                      glm::vec3(block.v1x[lane], block.v1y[lane], block.v1z[lane]),
                                      glm::vec3(block.v2x[lane], block.v2y[lane], block.v2z[lane])})
                EXPECT_TRUE(glm::all(glm::lessThanEqual(box.lo, v)) && glm::all(glm::lessThanEqual(v, box.hi)));
        }
    }
}

TEST(WideBvh, HoldsEveryTriangleOnceInContainingBoxes) {
    for (const std::size_t count : {1u, 2u, 3u, 4u, 5u, 9u, 33u, 1000u, 5003u}) {
        const Bvh bvh = build(soup(count, 0.05f, count), 63, Layout::wide);
        WideCheck check;
        walk_wide(state_of(bvh).wide_nodes.read(), state_of(bvh).wide_blocks.read(), 0,
                  Bounds{glm::vec3(-10), glm::vec3(10)}, check);
        EXPECT_EQ(check.nodes, state_of(bvh).read_header().wide_nodes);
        EXPECT_EQ(check.blocks, state_of(bvh).read_header().wide_blocks);
        ASSERT_EQ(check.primitives.size(), count);
        for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(check.primitives.count(i), 1u);
    }
}

/// A tree from the root down takes the children of least cost; those of largest area leave half of the places free.
TEST(WideBvh, FillsNodesByCost) {
    const Mesh mesh = soup(5003, 0.05f, 3);
    const auto children_per_node = [&](Builder builder) {
        const BvhHeader header = state_of(build(mesh, 63, Layout::wide, builder)).read_header();
        return double(header.wide_nodes - 1 + header.wide_blocks) / double(header.wide_nodes);
    };
    EXPECT_GT(children_per_node(Builder::binned), 1.25 * children_per_node(Builder::balanced));
}

/// In large scenes numbers are taken several at once, and nodes with none of them are left over.
TEST(WideBvh, MarksWhatIsLeftOver) {
    const std::size_t count = 150'000;
    for (const Builder builder : {Builder::fast, Builder::balanced}) {
        const Bvh bvh = build(soup(count, 0.01f, 1), 63, Layout::wide, builder);
        const std::vector<WideNode> nodes = state_of(bvh).wide_nodes.read();
        const BvhHeader header = state_of(bvh).read_header();
        WideCheck check;
        walk_wide(nodes, state_of(bvh).wide_blocks.read(), 0, Bounds{glm::vec3(-10), glm::vec3(10)}, check);
        EXPECT_EQ(std::set(check.primitives.begin(), check.primitives.end()).size(), count);
        EXPECT_EQ(check.primitives.size(), count);
        ASSERT_LE(header.wide_nodes, nodes.size());
        EXPECT_LE(header.wide_blocks, state_of(bvh).wide_blocks.size());
        std::size_t empty = 0;
        for (std::uint32_t i = 0; i < header.wide_nodes; ++i)
            empty += std::all_of(std::begin(nodes[i].child), std::end(nodes[i].child),
                                 [](std::uint32_t child) { return child == CLARAY_NO_CHILD; });
        EXPECT_EQ(check.nodes + empty, header.wide_nodes);
        EXPECT_LT(empty, count / 100);
    }
}

TEST(WideBvh, NeedsNoMoreThanItsMemory) {
    Mesh equal = soup(1, 0.5f, 1), line;
    equal.triangles.assign(4099, glm::uvec3(0, 1, 2));
    for (std::uint32_t i = 0; i < 1000; ++i) {  // every triangle far larger than the one before: a degenerate chain
        const float s = std::exp2(float(i % 60));
        line.positions.insert(line.positions.end(), {{s, 0, 0}, {s, s, 0}, {s, 0, s}});
        line.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    for (const Mesh& mesh : {equal, line}) {
        const Bvh bvh = build(mesh, 63, Layout::wide);
        EXPECT_LE(state_of(bvh).read_header().wide_nodes, state_of(bvh).wide_nodes.size());
        EXPECT_LE(state_of(bvh).read_header().wide_blocks, state_of(bvh).wide_blocks.size());
    }
}

}  // namespace
}  // namespace claray::test
