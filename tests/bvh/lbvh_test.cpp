// Bounds, Morton codes and hierarchy of the fast builder: bvh/bounds.cl, bvh/morton_codes.cl, bvh/lbvh.cl.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

/// bits + ceil(log2 N): each level consumes a bit of the code or of the index.
unsigned height_bound(unsigned bits, std::size_t triangles) { return bits + unsigned(std::bit_width(triangles)); }

TEST(Bvh, IsValidAtEverySize) {
    for (const unsigned bits : {30u, 63u})
        for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 5u, 31u, 64u, 257u, 1000u, 5003u}) {
            const Mesh mesh = soup(count, 0.05f, count);
            const Bvh bvh = build(mesh, bits);
            SCOPED_TRACE(testing::Message() << count << " triangles, " << bits << " bits");
            expect_valid(bvh);
            const BvhHeader header = state_of(bvh).read_header();
            EXPECT_EQ(header.valid, count);
            EXPECT_EQ(header.culled, 0u);
            EXPECT_LE(header.height, height_bound(bits, count));
            if (count == 0) {
                EXPECT_EQ(header.root, CLARAY_NO_CHILD);
            }
            expect_bounds(bvh, mesh);
        }
}

TEST(Bvh, TakesAnyNumberOfEqualTriangles) {
    Mesh mesh = soup(1, 0.5f, 1);
    mesh.triangles.assign(10'000, glm::uvec3(0, 1, 2));
    for (const unsigned bits : {30u, 63u}) {
        const Bvh bvh = build(mesh, bits);
        expect_valid(bvh);
        EXPECT_EQ(state_of(bvh).read_header().height,
                  12u);  // balanced by index, to leaves of four: ceil(log2 10000) - 2
    }
}

TEST(Bvh, CullsJunkAndKeepsIndices) {
    const Mesh clean = soup(1000, 0.05f, 3);
    Mesh dirty = clean;
    const auto junk = std::uint32_t(dirty.positions.size());
    dirty.positions.insert(dirty.positions.end(),
                           {{nan, 0, 0}, {0, infinity, 0}, {1e30f, 0, 0}, {0, 0, -infinity}, {-3e38f, 0, 0}});
    for (std::uint32_t bad = 0; bad < 5; ++bad) dirty.triangles.emplace_back(0, 1, junk + bad);
    dirty.triangles.emplace_back(4, 4, 5);  // two equal vertices
    const Bvh bvh = build(dirty);
    expect_valid(bvh);
    EXPECT_EQ(state_of(bvh).read_header().valid, 1000u);
    EXPECT_EQ(state_of(bvh).read_header().culled, 6u);
    EXPECT_EQ(bvh.hash(), build(clean).hash());
}

TEST(Bvh, CullsEverythingIfNothingIsValid) {
    Mesh mesh;
    mesh.positions = {{nan, nan, nan}, {0, 0, 0}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {1, 1, 2}};
    const Bvh bvh = build(mesh, 63, Layout::wide);
    EXPECT_EQ(state_of(bvh).read_header().valid, 0u);
    EXPECT_EQ(state_of(bvh).read_header().culled, 2u);
    expect_valid(bvh);
}

TEST(Bvh, NegativeZeroIsZero) {
    Mesh mesh = grid(4), negative = mesh;
    for (glm::vec3& p : negative.positions) p.z = -0.0f;
    EXPECT_EQ(build(mesh).hash(), build(negative).hash());
}

TEST(Bvh, KeepsDenormals) {
    Mesh mesh = grid(4);
    for (glm::vec3& p : mesh.positions) p *= 1e-41f;
    const Bvh bvh = build(mesh);
    expect_valid(bvh);
    EXPECT_EQ(state_of(bvh).read_header().hix, 1.f * 1e-41f);
}

TEST(Bvh, RefusesIndicesOutOfRange) {
    Mesh mesh = grid(2);
    mesh.name = "floor";
    mesh.triangles[3].y = 9;
    try {
        (void)build(mesh);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::user);
        EXPECT_STREQ(error.what(), "mesh 0 'floor', triangle 3: vertex 9 of 9 does not exist");
    }
}

TEST(Bvh, RefusesOtherCodes) { EXPECT_THROW((void)build(grid(2), 42), Error); }

double half_area(const glm::dvec3& e) { return e.x * e.y + e.y * e.z + e.z * e.x; }

TEST(Bvh, SahCostEqualsTheHosts) {
    const Bvh bvh = build(soup(3001, 0.05f, 9));
    const BvhHeader header = state_of(bvh).read_header();
    double cost = 0;
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    for (const BvhNode& n : std::span(nodes).first(header.valid - 1)) {
        if (n.child0 == CLARAY_NO_CHILD) continue;  // a number that is free
        const glm::dvec3 lo0(n.lo0x, n.lo0y, n.lo0z), hi0(n.hi0x, n.hi0y, n.hi0z), lo1(n.lo1x, n.lo1y, n.lo1z),
            hi1(n.hi1x, n.hi1y, n.hi1z);
        cost += half_area(glm::max(hi0, hi1) - glm::min(lo0, lo1));
        if (n.child0 & CLARAY_LEAF) cost += half_area(hi0 - lo0) * CLARAY_LEAF_COUNT(n.child0);
        if (n.child1 & CLARAY_LEAF) cost += half_area(hi1 - lo1) * CLARAY_LEAF_COUNT(n.child1);
    }
    cost /= half_area({header.hix - header.lox, header.hiy - header.loy, header.hiz - header.loz});
    EXPECT_NEAR(bvh.statistics().sah_cost / cost, 1.0, 1e-5);
}

/// Small triangles whose centres are multiples of a 64th in a box of 16 x 5 x 11, so that no step of a code rounds.
/// Some are in the same cell of a coarse grid, and two are its corners.
Mesh triangles_on_a_grid() {
    const glm::vec3 corner(-3.f, 100.f, 7.f), size(16.f, 5.f, 11.f);
    std::mt19937 random(4);
    Mesh mesh;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        glm::vec3 centre = i == 0 ? corner : corner + size;
        if (i > 1)
            for (int axis = 0; axis < 3; ++axis)
                centre[axis] = corner[axis] + float(random() % std::uint32_t(64 * size[axis] + 1)) / 64.f;
        mesh.positions.insert(mesh.positions.end(),
                              {centre - glm::vec3(0.25f, 0.25f, 0), centre + glm::vec3(0.25f, -0.25f, 0),
                               centre + glm::vec3(0, 0.25f, 0)});
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

/// The cells of the triangles' centres, in a grid of 2^`axis_bits` cubes along the longest axis, which is x.
std::vector<glm::u64vec3> cells_of(const Mesh& mesh, unsigned axis_bits) {
    std::vector<glm::dvec3> centres;
    glm::dvec3 lo(1e9), hi(-1e9);
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        centres.push_back((glm::min(glm::min(a, b), c) + glm::max(glm::max(a, b), c)) / 2.0);
        lo = glm::min(lo, centres.back()), hi = glm::max(hi, centres.back());
    }
    const double cells = std::exp2(axis_bits);
    std::vector<glm::u64vec3> all;
    for (const glm::dvec3& centre : centres)
        all.emplace_back(glm::min((centre - lo) / (hi.x - lo.x) * cells, glm::dvec3(cells - 1)));
    return all;
}

/// Whether cell a precedes cell b: at the highest bit in which they differ, of x before y before z (Morton 1966).
bool precedes(const glm::u64vec3& a, const glm::u64vec3& b) {
    for (int bit = 20; bit >= 0; --bit)
        for (int axis = 0; axis < 3; ++axis)
            if (((a[axis] ^ b[axis]) >> bit & 1) != 0) return (b[axis] >> bit & 1) != 0;
    return false;
}

/// Slots of the leaves as an in-order traversal of the tree meets them.
std::vector<std::uint32_t> slots_in_order(const Bvh& bvh) {
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    std::vector<std::uint32_t> stack = {state_of(bvh).read_header().root}, slots;
    while (!stack.empty()) {
        const std::uint32_t child = stack.back();
        stack.pop_back();
        if (child & CLARAY_LEAF)
            for (std::uint32_t i = 0; i < CLARAY_LEAF_COUNT(child); ++i) slots.push_back((child & CLARAY_SLOT) + i);
        else
            stack.insert(stack.end(), {nodes[child].child1, nodes[child].child0});
    }
    return slots;
}

TEST(Bvh, LeavesFollowTheMortonCurve) {
    const Mesh mesh = triangles_on_a_grid();
    for (const unsigned bits : {30u, 63u}) {
        const std::vector<glm::u64vec3> cells = cells_of(mesh, bits / 3);
        std::vector<std::uint32_t> expected(mesh.triangles.size());
        std::iota(expected.begin(), expected.end(), 0u);
        std::stable_sort(expected.begin(), expected.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return precedes(cells[a], cells[b]); });
        const Bvh bvh = build(mesh, bits);
        const std::vector<LeafTriangle> leaves = state_of(bvh).leaves.read();
        std::vector<std::uint32_t> met;
        for (const std::uint32_t slot : slots_in_order(bvh)) met.push_back(leaves[slot].primitive);
        EXPECT_EQ(met, expected) << bits << " bits";
    }
}

TEST(Bvh, TakesNoPoints) { EXPECT_EQ(state_of(build(soup(2000, 0.f, 4))).read_header().valid, 0u); }

/// Cells are cubes: a scene a hundred times as wide as high is split along its width for at least twelve levels.
TEST(Bvh, SplitsFlatScenesAlong) {
    Mesh mesh = soup(20'000, 1e-4f, 3);
    for (glm::vec3& position : mesh.positions) position.x *= 100.f, position.y *= 100.f;
    const Bvh bvh = build(mesh);
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    std::vector<std::pair<std::uint32_t, int>> stack = {{state_of(bvh).read_header().root, 0}};
    while (!stack.empty()) {
        const auto [child, level] = stack.back();
        stack.pop_back();
        if ((child & CLARAY_LEAF) != 0 || level == 12) continue;
        const BvhNode& n = nodes[child];
        const float apart =
            std::max(std::max(n.lo1x - n.hi0x, n.lo0x - n.hi1x), std::max(n.lo1y - n.hi0y, n.lo0y - n.hi1y));
        ASSERT_GT(apart, -0.05f) << "level " << level;
        stack.insert(stack.end(), {{n.child0, level + 1}, {n.child1, level + 1}});
    }
}

/// The tree that build_lbvh makes of sorted codes, without joining leaves.
std::vector<BvhNode> tree_over(const std::vector<std::uint32_t>& codes, BvhHeader* header) {
    const auto count = std::uint32_t(codes.size());
    const Mesh mesh = soup(count, 0.1f, 1);
    const TriangleBuffers triangles = build(mesh).triangles();
    std::vector<std::uint32_t> order(count);
    for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
    *header = {};
    header->valid = count, header->inner_nodes = count - 1;
    const Buffer<BvhHeader> headers(device(), std::vector<BvhHeader>{*header});
    const Buffer<BvhNode> nodes(device(), count);
    const Buffer<LeafTriangle> leaves(device(), count);
    Buffer<std::uint32_t> arrivals(device(), count);
    arrivals.fill(0xffffffffu);
    load_kernel(device(), "bvh/lbvh.cl", "build_lbvh", {{"CODE_BITS", "30"}})
        .run({count, 256}, triangles.positions, arg("indices", triangles.indices),
             arg("geometries", triangles.geometries), arg("masks", triangles.masks),
             arg("codes", Buffer<std::uint32_t>(device(), codes)), arg("order", Buffer<std::uint32_t>(device(), order)),
             nodes, leaves, arg("arrivals", arrivals), headers);
    *header = headers.read()[0];
    return nodes.read();
}

/// The example of four codes by which the radix tree is usually explained: the first bit that differs separates 1000
/// from the rest, the next one 1111, the last one 1100 from 1101. Node i splits between codes i and i + 1.
TEST(Bvh, SplitsFourCodesByTheirHighestDifferingBits) {
    BvhHeader header;
    const std::vector<BvhNode> nodes = tree_over({0b1000, 0b1100, 0b1101, 0b1111}, &header);
    EXPECT_EQ(header.root, 0u);
    EXPECT_EQ(header.height, 3u);
    EXPECT_EQ(nodes[0].child0, CLARAY_LEAF | 0u);
    EXPECT_EQ(nodes[0].child1, 2u);
    EXPECT_EQ(nodes[2].child0, 1u);
    EXPECT_EQ(nodes[2].child1, CLARAY_LEAF | 3u);
    EXPECT_EQ(nodes[1].child0, CLARAY_LEAF | 1u);
    EXPECT_EQ(nodes[1].child1, CLARAY_LEAF | 2u);
    EXPECT_EQ(nodes[0].parent, CLARAY_NO_CHILD);
    EXPECT_EQ(nodes[1].parent, 2u);
    EXPECT_EQ(nodes[2].parent, 0u);
}

/// Equal codes are told apart by their indices 0 to 3, in binary 00, 01, 10, 11.
TEST(Bvh, SplitsEqualCodesByTheirIndices) {
    BvhHeader header;
    const std::vector<BvhNode> nodes = tree_over({0b1010, 0b1010, 0b1010, 0b1010}, &header);
    EXPECT_EQ(header.root, 1u);
    EXPECT_EQ(header.height, 2u);
    EXPECT_EQ(nodes[1].child0, 0u);
    EXPECT_EQ(nodes[1].child1, 2u);
}

/// Node i splits between leaves i and i + 1, and no other place in its range has a higher differing bit.
TEST(Bvh, SplitsWhereTheHighestBitDiffers) {
    const Bvh bvh = build(soup(3000, 0.01f, 8));
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    struct Range {
        std::uint32_t child, first, last;
    };
    std::vector<Range> stack = {{state_of(bvh).read_header().root, 0, 2999}};
    while (!stack.empty()) {
        const auto [child, first, last] = stack.back();
        stack.pop_back();
        if (child & CLARAY_LEAF) {
            ASSERT_EQ(child & CLARAY_SLOT, first);
            ASSERT_EQ(first + CLARAY_LEAF_COUNT(child) - 1, last);
            continue;
        }
        ASSERT_LE(first, child);
        ASSERT_LT(child, last);
        stack.push_back({nodes[child].child0, first, child});
        stack.push_back({nodes[child].child1, child + 1, last});
        ASSERT_EQ(nodes[child].height_count & CLARAY_COUNT_LIMIT, last - first + 1);
    }
}

}  // namespace
}  // namespace claray::test
