// host/accuracy/studies/trees: accuracy/karras.cl against bvh/lbvh.cl, accuracy/trace_cells.cl against the shipped
// query.
#include <gtest/gtest.h>

#include <cstring>

#include "claray/query.hpp"
#include "host/accuracy/studies/trees/cells.hpp"
#include "host/accuracy/studies/trees/karras.hpp"
#include "host/accuracy/study.hpp"
#include "host/bvh/bvh_state.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using verify::grid;

Bvh linear_bvh(const Mesh& mesh, unsigned max_leaf) {
    return Bvh::build(device(), std::span(&mesh, 1),
                      {.builder = Builder::fast, .layout = Layout::binary, .max_leaf_triangles = max_leaf});
}

bool is_free(const BvhNode& node) { return node.child0 == CLARAY_NO_CHILD; }

/// All words of all nodes that are in use, of all leaves, and of the header but the grid's.
void expect_same_tree(const Mesh& mesh, unsigned max_leaf) {
    const Bvh apetrei = linear_bvh(mesh, max_leaf);
    KarrasTree karras(device(), sort_triangles(device(), apetrei.triangles()), max_leaf);
    karras.build();
    const BvhHeader expected = state_of(apetrei).read_header(), header = karras.header().read()[0];
    EXPECT_EQ(header.root, expected.root);
    EXPECT_EQ(header.valid, expected.valid);
    EXPECT_EQ(header.culled, expected.culled);
    EXPECT_EQ(header.height, expected.height);
    EXPECT_EQ(header.inner_nodes, expected.inner_nodes);
    if (expected.valid == 0) return;
    EXPECT_EQ(std::memcmp(&header, &expected, 6 * sizeof(float)), 0) << "bounds";
    const std::vector<BvhNode> nodes = karras.nodes().read(), expected_nodes = state_of(apetrei).nodes.read();
    for (std::uint32_t i = 0; i < expected.inner_nodes; ++i) {
        ASSERT_EQ(is_free(nodes[i]), is_free(expected_nodes[i])) << i;
        ASSERT_TRUE(is_free(nodes[i]) || std::memcmp(&nodes[i], &expected_nodes[i], sizeof(BvhNode)) == 0) << i;
    }
    const std::vector<LeafTriangle> leaves = karras.leaves().read(), expected_leaves = state_of(apetrei).leaves.read();
    EXPECT_EQ(std::memcmp(leaves.data(), expected_leaves.data(), expected.valid * sizeof(LeafTriangle)), 0);
}

TEST(KarrasTree, IsApetreisTree) {
    for (const unsigned max_leaf : {1u, 4u})
        for (const std::size_t count : {1u, 2u, 3u, 64u, 257u, 5003u}) {
            SCOPED_TRACE(testing::Message() << count << " triangles, leaves of " << max_leaf);
            expect_same_tree(soup(count, 0.05f, count), max_leaf);
        }
}

/// Triangles with the same code, alone and in runs among others, and culled ones.
TEST(KarrasTree, IsApetreisTreeForEqualCodes) {
    Mesh equal = soup(1, 0.5f, 1);
    equal.triangles.assign(3001, glm::uvec3(0, 1, 2));
    expect_same_tree(equal, 1);
    Mesh runs = soup(300, 0.05f, 2);
    for (std::uint32_t i = 0; i < 300; i += 7)
        runs.triangles.insert(runs.triangles.end(), 1 + i % 5, runs.triangles[i]);
    runs.triangles.emplace_back(4, 4, 5);
    for (const unsigned max_leaf : {1u, 4u}) expect_same_tree(runs, max_leaf);
}

/// The example of tests/bvh/lbvh_test.cpp.
TEST(KarrasTree, SplitsFourCodesByTheirHighestDifferingBits) {
    const Mesh mesh = soup(4, 0.1f, 1);
    BvhHeader counts{};
    counts.valid = 4, counts.inner_nodes = 3;
    const SortedTriangles four{
        linear_bvh(mesh, 1).triangles(),
        Buffer<std::uint64_t>(device(), std::vector<std::uint64_t>{0b1000, 0b1100, 0b1101, 0b1111}),
        Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{0, 1, 2, 3}),
        Buffer<BvhHeader>(device(), std::vector<BvhHeader>{counts})};
    KarrasTree tree(device(), four, 1);
    tree.build();
    const std::vector<BvhNode> nodes = tree.nodes().read();
    EXPECT_EQ(tree.header().read()[0].root, 0u);
    EXPECT_EQ(nodes[0].child0, CLARAY_LEAF | 0u);
    EXPECT_EQ(nodes[0].child1, 2u);
    EXPECT_EQ(nodes[2].child0, 1u);
    EXPECT_EQ(nodes[2].child1, CLARAY_LEAF | 3u);
    EXPECT_EQ(nodes[1].child0, CLARAY_LEAF | 1u);
    EXPECT_EQ(nodes[1].child1, CLARAY_LEAF | 2u);
}

std::vector<LeafTriangle> triangles_of(const Mesh& mesh) {
    const Bvh bvh = linear_bvh(mesh, 4);
    std::vector<LeafTriangle> triangles = state_of(bvh).leaves.read();
    triangles.resize(state_of(bvh).read_header().valid);
    return triangles;
}

/// The leaf whose cell holds a point: a point on a plane may be sought on either side.
std::uint32_t leaf_at(const CellTree& tree, const glm::vec3& point, bool octree) {
    std::uint32_t index = 0;
    while (tree.nodes[index].count == CLARAY_CELL_HAS_CHILDREN) {
        const CellNode& node = tree.nodes[index];
        std::uint32_t place = 0;
        if (octree)
            for (unsigned axis = 0; axis < 3; ++axis) place |= unsigned(point[axis] > node.plane[axis]) << axis;
        else
            place = unsigned(point[node.axis] > node.plane[node.axis]);
        index = node.first + place;
    }
    return index;
}

/// Points of triangles are in leaves that list these triangles; leaves are small.
TEST(CellTrees, ListTrianglesWhereTheyAre) {
    Mesh mesh = soup(3000, 0.2f, 5);
    const Mesh floor = grid(9);  // in the plane z = 0
    for (const glm::uvec3& t : floor.triangles) mesh.triangles.push_back(t + glm::uvec3(mesh.positions.size()));
    mesh.positions.insert(mesh.positions.end(), floor.positions.begin(), floor.positions.end());
    const std::vector<LeafTriangle> triangles = triangles_of(mesh);
    for (const bool octree : {true, false}) {
        const CellTree tree = octree ? build_octree(triangles) : build_kd_tree(triangles);
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            const LeafTriangle& t = triangles[i];
            const glm::vec3 a(t.v0x, t.v0y, t.v0z), b(t.v1x, t.v1y, t.v1z), c(t.v2x, t.v2y, t.v2z);
            for (const glm::vec3 weights : {glm::vec3(0.5f, 0.25f, 0.25f), glm::vec3(0.1f, 0.7f, 0.2f)}) {
                const glm::vec3 point = weights.x * a + weights.y * b + weights.z * c;
                const CellNode& leaf = tree.nodes[leaf_at(tree, point, octree)];
                const auto begin = tree.lists.begin() + leaf.first, end = begin + leaf.count;
                ASSERT_NE(std::find(begin, end, i), end) << (octree ? "octree" : "k-d tree") << ", triangle " << i;
            }
        }
        std::size_t listed = 0, leaves = 0;
        for (const CellNode& node : tree.nodes)
            if (node.count != CLARAY_CELL_HAS_CHILDREN) listed += node.count, ++leaves;
        EXPECT_EQ(listed, tree.lists.size());
        EXPECT_LT(double(listed) / double(leaves), 16.0);
        EXPECT_GT(tree.height, 3u);
    }
    EXPECT_TRUE(build_octree({}).nodes.empty());
    EXPECT_TRUE(build_kd_tree({}).nodes.empty());
}

/// Faces along the axes lie in planes of cells, with rays in them; a study whose trees disagree reports it.
TEST(TreesStudy, TreesAgreeAboutEveryHit) {
    const Study study = study_trees(device(), *builtin_scene("cornell"), {.runs = 1, .rays = 4096});
    ASSERT_EQ(study.points.size(), 7u);
    for (const StudyPoint& p : study.points) {
        EXPECT_EQ(p.failure, "") << p.method;
        EXPECT_GT(fact_of(p, "boxes a ray"), 3) << p.method;
        EXPECT_LT(fact_of(p, "triangles a ray"), 36) << p.method;
    }
    const auto boxes = [&](std::size_t i) { return fact_of(study.points[i], "boxes a ray"); };
    EXPECT_EQ(study.points[2].method, "LBVH, Karras");
    EXPECT_EQ(boxes(2), boxes(3)) << "the trees of Karras and Apetrei are the same";
    EXPECT_LE(boxes(5), boxes(3) * 1.1) << "binned SAH against the linear BVH";
}

}  // namespace
}  // namespace claray::test
