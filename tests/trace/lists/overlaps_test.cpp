// Triangles that overlap shapes: trace/overlaps/overlap_boxes.cl and trace/overlaps/overlap_spheres.cl.
#include "claray/query/overlaps.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/oracle/nearest.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

using Ids = std::vector<std::uint32_t>;

using verify::overlaps;

class OverlapsTest : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(const Mesh& mesh, Builder builder = Builder::fast) {
        return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .layout = GetParam()});
    }
};

Ids list_of(const HostLists<std::uint32_t>& lists, std::size_t i) {
    return {lists.elements.begin() + lists.offsets[i], lists.elements.begin() + lists.offsets[i + 1]};
}

std::vector<Bounds> random_boxes(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Bounds> boxes(count);
    for (Bounds& box : boxes) {
        const glm::vec3 size = random.uniform() * glm::abs(random.in_cube(1));
        box.lo = random.in_cube(1.2f);
        box.hi = box.lo + size;
    }
    return boxes;
}

TEST_P(OverlapsTest, OfBoxesEqualTheOracle) {
    const Mesh mesh = soup(1003, 0.3f, 1);
    const std::vector<Bounds> boxes = random_boxes(301, 2);
    const HostLists<std::uint32_t> found = box_overlaps(build(mesh), boxes);
    std::size_t total = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        Ids expected;
        for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p)
            if (overlaps(mesh, p, boxes[i])) expected.push_back(p);
        ASSERT_EQ(list_of(found, i), expected) << i;
        total += expected.size();
    }
    EXPECT_GT(total, 1000u);
}

TEST_P(OverlapsTest, OfSpheresEqualTheOracle) {
    const Mesh mesh = soup(1003, 0.3f, 3);
    const NearestOracle oracle(mesh);
    Random random(4);
    std::vector<Sphere> spheres(301);
    for (Sphere& sphere : spheres) sphere = {random.in_cube(1.2f), 0.5f * random.uniform()};
    const HostLists<std::uint32_t> found = sphere_overlaps(build(mesh), spheres);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        Ids expected;
        for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p)
            if (oracle.distance(spheres[i].center, p) <= spheres[i].radius) expected.push_back(p);
        ASSERT_EQ(list_of(found, i), expected) << i;
    }
}

TEST_P(OverlapsTest, CountTheSameInSplitTrees) {
    const Mesh mesh = ball_with_dust();
    const std::vector<Bounds> boxes = random_boxes(203, 6);
    const Bvh split = build(mesh, Builder::high);
    EXPECT_GT(split.statistics().references, 50u);
    const HostLists<std::uint32_t> here = box_overlaps(build(mesh), boxes), there = box_overlaps(split, boxes);
    EXPECT_EQ(here.offsets, there.offsets);
    EXPECT_EQ(here.elements, there.elements);
    const Buffer<float> on_device(device(), std::span(&boxes[0].lo.x, 6 * boxes.size()));
    Buffer<std::uint32_t> counts(device(), boxes.size());
    for (const Bvh& bvh : {build(mesh), split}) {
        count_box_overlaps(bvh, on_device, counts);
        const Ids numbers = counts.read();
        for (std::size_t i = 0; i < boxes.size(); ++i) ASSERT_EQ(numbers[i], list_of(here, i).size()) << i;
    }
}

TEST_P(OverlapsTest, IncludeTouchingShapes) {
    const Mesh mesh = grid(1);  // two triangles in the unit square z = 0
    const Bvh bvh = build(mesh);
    const float below = std::nextafter(0.f, -1.f);
    const std::vector<Bounds> boxes = {{{0, 0, 0}, {1, 1, 1}},               // on the square
                                       {{1, 1, 0}, {2, 2, 1}},               // at its corner
                                       {{0.75f, 0.2f, 0}, {1, 0.25f, 0}},    // flat, in one triangle
                                       {{0, 0, -1}, {1, 1, below}},          // just below
                                       {{0.5f, 0.5f, 1}, {0.5f, 0.5f, -1}},  // lo > hi
                                       {{nan, 0, 0}, {1, 1, 1}},
                                       {{0.5f, 0.5f, 0}, {0.5f, 0.5f, 0}}};  // a point on the diagonal
    const HostLists<std::uint32_t> found = box_overlaps(bvh, boxes);
    std::vector<std::size_t> sizes;
    for (std::size_t i = 0; i < boxes.size(); ++i) sizes.push_back(list_of(found, i).size());
    EXPECT_EQ(sizes, (std::vector<std::size_t>{2, 2, 1, 0, 0, 0, 2}));
    const std::vector<Sphere> spheres = {{{0.75f, 0.25f, 2}, 2.f}, {{0.75f, 0.25f, 2}, std::nextafter(2.f, 0.f)},
                                         {{0.5f, 0.5f, 0}, 0.f},   {{0.5f, 0.5f, 0}, -1.f},
                                         {{0.5f, nan, 0}, 1.f},    {{0.5f, 0.5f, 0}, 1e30f}};
    const HostLists<std::uint32_t> balls = sphere_overlaps(bvh, spheres);
    sizes.clear();
    for (std::size_t i = 0; i < spheres.size(); ++i) sizes.push_back(list_of(balls, i).size());
    EXPECT_EQ(sizes, (std::vector<std::size_t>{1, 0, 2, 0, 0, 2}));
}

TEST_P(OverlapsTest, OfNothingAreNone) {
    EXPECT_TRUE(box_overlaps(build(Mesh{}), random_boxes(2, 7)).elements.empty());
    EXPECT_EQ(sphere_overlaps(build(grid(1)), std::vector<Sphere>{}).offsets, Ids{0});
    Buffer<std::uint32_t> counts(device(), 1);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "6 floats",
                             [&] { count_box_overlaps(build(grid(1)), Buffer<float>(device(), 7), counts); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "counts",
                             [&] { count_sphere_overlaps(build(grid(1)), Buffer<float>(device(), 8), counts); }));
}

INSTANTIATE_TEST_SUITE_P(Layouts, OverlapsTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "Wide" : "Binary"; });

}  // namespace
}  // namespace claray::test
