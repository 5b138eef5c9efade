// The lower end of the best tree, bvh/sbvh_small.cl and bvh/serial/sbvh_serial.cl, alone: its splits against all that
// there are, and how deep it goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>

#include "claray/program.hpp"
#include "claray/shared/bvh_node.h"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

struct Box {
    glm::vec3 lo{1e30f}, hi{-1e30f};
    void add(const Box& b) { lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi); }
    [[nodiscard]] double half_area() const {
        const glm::dvec3 size = glm::dvec3(hi) - glm::dvec3(lo);
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
    bool operator==(const Box&) const = default;
};

struct Task {  // as kernels/bvh/sbvh/sbvh.clh has it
    std::uint32_t begin, capacity, at, count, node, depth;
};

/// What is made of boxes by a single task at a depth.
struct SmallTree {
    std::vector<Box> boxes;
    std::vector<BvhNode> nodes;
    std::vector<LeafTriangle> leaves;

    [[nodiscard]] std::vector<std::uint32_t> below(std::uint32_t child) const {
        if (child & CLARAY_LEAF) return {leaves[child & CLARAY_SLOT].primitive};
        std::vector<std::uint32_t> all = below(nodes[child].child0), more = below(nodes[child].child1);
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    [[nodiscard]] unsigned height(std::uint32_t child) const {
        if (child & CLARAY_LEAF) return 0;
        return 1 + std::max(height(nodes[child].child0), height(nodes[child].child1));
    }
    [[nodiscard]] Box box_of(const std::vector<std::uint32_t>& primitives) const {
        Box box;
        for (const std::uint32_t p : primitives) box.add(boxes[p]);
        return box;
    }
};

/// By the kernel of groups, or by that of single work-items.
class SbvhSmall : public testing::TestWithParam<bool> {
protected:
    [[nodiscard]] static SmallTree finished(const std::vector<Box>& boxes, std::uint32_t depth);
};

SmallTree SbvhSmall::finished(const std::vector<Box>& boxes, std::uint32_t depth) {
    const auto count = std::uint32_t(boxes.size());
    std::vector<float> rows;
    for (std::uint32_t i = 0; i < count; ++i)
        rows.insert(rows.end(), {boxes[i].lo.x, boxes[i].lo.y, boxes[i].lo.z, std::bit_cast<float>(i), boxes[i].hi.x,
                                 boxes[i].hi.y, boxes[i].hi.z, 0.f});
    const Buffer<float> references(device(), rows);
    const Buffer<std::uint32_t> counters(device(), std::vector<std::uint32_t>{1, 0, 1});
    const Buffer<Task> tasks(device(), std::vector<Task>{{0, count, 0, count, 0, depth}});
    const Buffer<BvhNode> nodes(device(), count - 1);
    const Buffer<LeafTriangle> leaves(device(), count);
    if (GetParam())
        load_kernel(device(), "bvh/serial/sbvh_serial.cl", "finish_subtrees_serial")
            .run({1, 1}, tasks.memory(), 1u, 1u, arg("even", references), arg("odd", references), nodes, leaves,
                 counters);
    else
        load_kernel(device(), "bvh/sbvh_small.cl", "finish_subtrees")
            .run({32, 32}, tasks.memory(), arg("even", references), arg("odd", references), nodes, leaves, counters);
    EXPECT_EQ(counters.read(), (std::vector<std::uint32_t>{count - 1, count, 1}));
    return {boxes, nodes.read(), leaves.read()};
}

/// The cheapest of all splits between centroids, on all axes.
double cheapest(const SmallTree& tree, const std::vector<std::uint32_t>& primitives) {
    double best = 1e300;
    for (int axis = 0; axis < 3; ++axis)
        for (const std::uint32_t border : primitives) {
            const auto center = [&](std::uint32_t p) { return tree.boxes[p].lo[axis] + tree.boxes[p].hi[axis]; };
            std::vector<std::uint32_t> left, right;
            for (const std::uint32_t p : primitives) (center(p) <= center(border) ? left : right).push_back(p);
            if (right.empty()) continue;
            best = std::min(best, tree.box_of(left).half_area() * double(left.size()) +
                                      tree.box_of(right).half_area() * double(right.size()));
        }
    return best;
}

std::vector<Box> boxes_of(const Mesh& mesh) {
    std::vector<Box> boxes;
    for (const glm::uvec3 t : mesh.triangles) {
        Box box;
        for (int corner = 0; corner < 3; ++corner) {
            const glm::vec3 p = mesh.positions[t[corner]];
            box.add({p, p});
        }
        boxes.push_back(box);
    }
    return boxes;
}

TEST_P(SbvhSmall, TakesTheCheapestSplitOfAll) {
    for (const std::size_t count : {2u, 3u, 5u, 17u, 31u, 32u})
        for (const float size : {0.01f, 0.3f, 2.f}) {
            const SmallTree tree = finished(boxes_of(soup(count, size, count)), 0);
            std::vector<std::uint32_t> all = tree.below(0);
            EXPECT_EQ(std::set(all.begin(), all.end()).size(), count);
            for (const BvhNode& n : tree.nodes) {
                const std::vector<std::uint32_t> left = tree.below(n.child0), right = tree.below(n.child1);
                const Box a = tree.box_of(left), b = tree.box_of(right);
                EXPECT_EQ(a, (Box{{n.lo0x, n.lo0y, n.lo0z}, {n.hi0x, n.hi0y, n.hi0z}}));
                EXPECT_EQ(b, (Box{{n.lo1x, n.lo1y, n.lo1z}, {n.hi1x, n.hi1y, n.hi1z}}));
                std::vector<std::uint32_t> both = left;
                both.insert(both.end(), right.begin(), right.end());
                EXPECT_LE(a.half_area() * double(left.size()) + b.half_area() * double(right.size()),
                          cheapest(tree, both) * (1 + 1e-5));
            }
        }
}

/// Of boxes one far in the other splits cut off one after the other: 31 levels. From depth 48 on they are halved.
TEST_P(SbvhSmall, HalvesWhatIsDeep) {
    std::vector<Box> shells;
    for (int i = 0; i < 32; ++i) shells.push_back({glm::vec3(0.f), glm::vec3(std::ldexp(1.f, 3 * i - 46))});
    EXPECT_EQ(finished(shells, 0).height(0), 31u);
    EXPECT_EQ(finished(shells, 38).height(0), 10u + 5u);
    EXPECT_EQ(finished(shells, 48).height(0), 5u);
}

/// Boxes with one common centroid are halved, too.
TEST_P(SbvhSmall, HalvesWhatNoPlaneParts) {
    EXPECT_EQ(finished(std::vector<Box>(32, Box{glm::vec3(-1.f), glm::vec3(1.f)}), 0).height(0), 5u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, SbvhSmall, testing::Bool(),
                         [](const auto& serial) { return serial.param ? "Serial" : "Groups"; });

}  // namespace
}  // namespace claray::test
