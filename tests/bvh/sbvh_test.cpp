// The builders `high` and `binned`: bvh/sbvh.cl, bvh/sbvh_large.cl, bvh/layout.cl.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"
#include "tests/bvh/support.hpp"
#include "tests/oracle/brute_force.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/process.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

/// With one triangle a leaf.
Bvh build_high(const Mesh& mesh, Layout layout = Layout::binary) {
    return Bvh::build(device(), std::span(&mesh, 1),
                      {.builder = Builder::high, .layout = layout, .max_leaf_triangles = 1});
}

Bvh build_high(const Mesh& mesh, double split_budget) {
    return Bvh::build(
        device(), std::span(&mesh, 1),
        {.builder = Builder::high, .layout = Layout::binary, .split_budget = split_budget, .max_leaf_triangles = 1});
}

/// Walls, some askew, round many small triangles: the case that splitting is for.
Mesh hall(std::size_t ornaments) {
    Mesh mesh = soup(ornaments, 0.01f, 6);
    const auto quad = [&](glm::vec3 corner, glm::vec3 a, glm::vec3 b) {
        const auto base = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {corner, corner + a, corner + a + b, corner + b});
        mesh.triangles.insert(mesh.triangles.end(), {{base, base + 1, base + 2}, {base, base + 2, base + 3}});
    };
    for (const float s : {-1.f, 1.f})
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 corner(-1.f), a(0.f), b(0.f);
            corner[axis] = s, a[(axis + 1) % 3] = 2.f, b[(axis + 2) % 3] = 2.f;
            quad(corner, a, b);
            quad(0.9f * corner, a * 0.9f + 0.3f * b, b * 0.7f - 0.2f * corner);
        }
    return mesh;
}

/// Boxes of the leaves by primitive.
std::vector<std::vector<Bounds>> leaf_boxes(const Bvh& bvh) {
    std::vector<std::vector<Bounds>> boxes(bvh.triangle_count());
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    const std::vector<LeafTriangle> leaves = state_of(bvh).leaves.read();
    const std::uint32_t valid = state_of(bvh).read_header().valid;
    for (std::uint32_t i = 0; i + 1 < valid; ++i) {
        const BvhNode& n = nodes[i];
        if (n.child0 & CLARAY_LEAF)
            boxes[leaves[n.child0 & CLARAY_SLOT].primitive].push_back(
                {{n.lo0x, n.lo0y, n.lo0z}, {n.hi0x, n.hi0y, n.hi0z}});
        if (n.child1 & CLARAY_LEAF)
            boxes[leaves[n.child1 & CLARAY_SLOT].primitive].push_back(
                {{n.lo1x, n.lo1y, n.lo1z}, {n.hi1x, n.hi1y, n.hi1z}});
    }
    return boxes;
}

TEST(High, IsValidAtEverySize) {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 5u, 17u, 33u, 257u, 5003u})
        for (const float size : {0.05f, 0.7f}) {
            const Mesh mesh = soup(count, size, count);
            const Bvh bvh = build_high(mesh);
            SCOPED_TRACE(testing::Message() << count << " triangles of size " << size);
            expect_valid(bvh);
            EXPECT_EQ(bvh.statistics().triangles, count);
            EXPECT_GE(state_of(bvh).read_header().valid, count);
            EXPECT_LE(double(state_of(bvh).read_header().valid), 1.5 * double(count));
            expect_bounds(bvh, mesh);
        }
}

/// Groups of one item use vectors instead of atomics, and references come in another order. The hall has nodes of all
/// sizes, the other meshes are split by number.
TEST(High, IsTheSameForGroupsOfAnySize) {
    Mesh same;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        same.positions.insert(same.positions.end(), {{-1, 0, 0}, {1, 1, 0}, {1, -1, 0}});
        same.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const Device groups = Device::open(), items = Device::open();
    const auto set_groups = [](const Device& of, unsigned large, unsigned medium, unsigned ranges) {
        of.set_tuning("bvh/sbvh", "LARGE_GROUP", large);
        of.set_tuning("bvh/sbvh", "MEDIUM_GROUP", medium);
        of.set_tuning("bvh/serial", "RANGES_PER_UNIT", ranges);
    };
    set_groups(groups, 64, 128, 0);
    set_groups(items, 1, 1, 16);
    for (const Mesh& mesh : {hall(20'000), same}) {
        const auto hash = [&](const Device& on) {
            return Bvh::build(on, std::span(&mesh, 1), {.builder = Builder::high, .layout = Layout::binary}).hash();
        };
        EXPECT_EQ(hash(groups), hash(items));
    }
}

TEST(High, SplitsWhatIsLargeAndLittleElse) {
    const Bvh high = build_high(hall(20'000));
    EXPECT_GT(high.statistics().references, 200u);
    const std::vector<std::vector<Bounds>> boxes = leaf_boxes(high);
    for (std::size_t wall = 20'000; wall < boxes.size(); ++wall) EXPECT_GT(boxes[wall].size(), 8u);

    for (const Mesh& mesh : {sphere(5), grid(70)})
        EXPECT_LT(build_high(mesh).statistics().references, mesh.triangles.size() / 5);
}

TEST(High, KeepsToItsBudget) {
    const Mesh mesh = hall(3000);
    const auto triangles = double(mesh.triangles.size());
    std::uint32_t fewer = 0;
    for (const double budget : {0.0, 0.01, 0.05, 0.5}) {
        const Bvh bvh = build_high(mesh, budget);
        expect_valid(bvh);
        const std::uint32_t references = bvh.statistics().references;
        EXPECT_LE(double(references), budget * triangles);
        EXPECT_TRUE(budget == 0 || references > fewer) << references << " at a budget of " << budget;
        fewer = references;
    }
}

/// Centroids that all coincide, boxes without volume, and triangles that no plane can part.
TEST(High, SplitsWhatNoPlaneParts) {
    Mesh same, flat;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        const float size = 1.f + float(i % 7);
        same.positions.insert(same.positions.end(), {{-size, 0, 0}, {size, size, 0}, {size, -size, 0}});
        flat.positions.insert(flat.positions.end(),
                              {{float(i), 0, 0}, {float(i) + 0.5f, 0, 0}, {float(i) + 2.f, 0, 0}});
        same.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        flat.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    for (const Mesh& mesh : {same, flat}) {
        const Bvh bvh = build_high(mesh);
        expect_valid(bvh);
        EXPECT_LE(state_of(bvh).read_header().height, 80u);
    }
}

TEST(High, GivesBetterTrees) {
    const auto cost = [](const Bvh& bvh) { return bvh.statistics().sah_cost; };
    const Mesh mesh = hall(20'000);
    const double balanced =
        cost(Bvh::build(device(), std::span(&mesh, 1),
                        {.builder = Builder::balanced, .layout = Layout::binary, .max_leaf_triangles = 1}));
    EXPECT_LT(cost(build_high(mesh)), 0.97 * balanced);
    EXPECT_LT(cost(build_high(mesh)), cost(build_high(mesh, 0.0)));
    const Mesh ball = sphere(5);
    EXPECT_LT(cost(build_high(ball)), cost(build(ball, 63, Layout::binary, Builder::balanced)));
}

/// `high` without its budget: each triangle has one leaf.
TEST(Binned, IsSahAlone) {
    for (const Mesh& mesh : {hall(3000), sphere(4)}) {
        const Bvh binned = Bvh::build(device(), std::span(&mesh, 1),
                                      {.builder = Builder::binned, .layout = Layout::binary, .max_leaf_triangles = 1});
        EXPECT_TRUE(binned.validate().ok());
        EXPECT_EQ(binned.statistics().references, 0u);
        EXPECT_EQ(binned.hash(), build_high(mesh, 0.0).hash());
        EXPECT_LT(binned.statistics().sah_cost, build(mesh, 63, Layout::binary, Builder::fast).statistics().sah_cost);
    }
}

using Point = std::array<long double, 3>;

bool holds(const Bounds& box, const Point& p) {
    for (int axis = 0; axis < 3; ++axis) {
        const long double slack = 1e-17L * std::fabs(p[axis]);  // of the long double itself
        if (p[axis] < box.lo[axis] - slack || p[axis] > box.hi[axis] + slack) return false;
    }
    return true;
}

/// Where the sides of the triangle cross the faces of its parts' boxes, and points between those: the parts touch
/// there, and a box rounded inwards would leave a gap.
std::vector<Point> critical_points(const glm::vec3 corners[3], const std::vector<Bounds>& boxes) {
    std::vector<Point> points;
    for (int side = 0; side < 3; ++side) {
        const glm::vec3 a = corners[side], b = corners[(side + 1) % 3];
        for (const Bounds& box : boxes)
            for (int axis = 0; axis < 3; ++axis)
                for (const float plane : {box.lo[axis], box.hi[axis]}) {
                    if (!(std::min(a[axis], b[axis]) < plane && plane < std::max(a[axis], b[axis]))) continue;
                    const long double p = ((long double)plane - a[axis]) / ((long double)b[axis] - a[axis]);
                    Point point;
                    for (int k = 0; k < 3; ++k) point[k] = a[k] + ((long double)b[k] - a[k]) * p;
                    point[axis] = plane;
                    points.push_back(point);
                }
    }
    const std::size_t crossings = points.size();
    for (std::size_t i = 1; i < crossings; ++i) {
        Point middle;
        for (int k = 0; k < 3; ++k) middle[k] = 0.5L * (points[i][k] + points[i - 1][k]);
        points.push_back(middle);
    }
    for (int corner = 0; corner < 3; ++corner)
        points.push_back({corners[corner].x, corners[corner].y, corners[corner].z});
    return points;
}

TEST(High, PartsCoverTheirTriangle) {
    Mesh tilted = hall(2000), far = tilted, tiny = tilted, slivers = soup(2000, 0.6f, 8);
    const glm::mat3 turn(0.36f, 0.48f, -0.8f, -0.8f, 0.6f, 0.f, 0.48f, 0.64f, 0.6f);
    for (glm::vec3& p : tilted.positions) p = turn * p;
    for (glm::vec3& p : far.positions) p = turn * p + glm::vec3(148376, 1234, -223423);
    for (glm::vec3& p : tiny.positions) p *= 1e-18f;
    for (std::size_t i = 0; i < slivers.positions.size(); i += 3)
        slivers.positions[i + 2] = glm::mix(slivers.positions[i], slivers.positions[i + 1], 0.3f);
    std::size_t checked = 0;
    for (const Mesh& mesh : {hall(2000), tilted, far, tiny, slivers, soup(500, 0.7f, 2)}) {
        const Bvh bvh = build_high(mesh, 8.0);
        expect_valid(bvh);
        const std::vector<std::vector<Bounds>> boxes = leaf_boxes(bvh);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const glm::uvec3 t = mesh.triangles[i];
            const glm::vec3 corners[3] = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
            if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;  // culled
            for (const Point& point : critical_points(corners, boxes[i])) {
                ++checked;
                ASSERT_TRUE(
                    std::any_of(boxes[i].begin(), boxes[i].end(), [&](const Bounds& box) { return holds(box, point); }))
                    << "triangle " << i << " of " << boxes[i].size() << " parts";
            }
        }
    }
    EXPECT_GT(checked, 30'000u);
}

/// Rays to points where parts of triangles touch: on planes of the grid, and through edges and vertices.
std::vector<Ray> rays_at_seams(const Mesh& mesh, const Bvh& bvh, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    const std::vector<std::vector<Bounds>> boxes = leaf_boxes(bvh);
    std::vector<glm::vec3> targets;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (boxes[i].size() < 2) continue;
        const glm::uvec3 t = mesh.triangles[i];
        const glm::vec3 corners[3] = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
        for (const Point& p : critical_points(corners, boxes[i]))
            targets.emplace_back(float(p[0]), float(p[1]), float(p[2]));
    }
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 target = targets[i * 7919 % targets.size()], origin = random.in_cube(3.f);
        rays.push_back(make_ray(origin, target - origin));
        if (i % 3 == 0) {  // along an axis, in a plane of the grid if the target is on one
            glm::vec3 direction(0.f), from = target;
            direction[int(i) % 9 / 3] = 1.f, from[int(i) % 9 / 3] = -5.f;
            rays.push_back(make_ray(from, direction));
        }
    }
    return rays;
}

class HighOnLayout : public testing::TestWithParam<Layout> {};

TEST_P(HighOnLayout, HitsEqualBruteForceBitForBit) {
    const Mesh mesh = hall(2000);
    const Bvh bvh = build_high(mesh, GetParam()), plain = build(mesh);
    std::vector<Ray> rays = rays_at_seams(mesh, build_high(mesh), 20'000, 4);
    const std::vector<Ray> others = random_rays(20'000, 4.f, 1.f, 5);
    rays.insert(rays.end(), others.begin(), others.end());
    const std::vector<Hit> hits = closest_hit(bvh, rays), expected = closest_hit(plain, rays, brute_force);
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].primitive, expected[i].primitive) << "ray " << i;
        ASSERT_EQ(hits[i].t, expected[i].t);
        ASSERT_EQ(hits[i].u, expected[i].u);
        ASSERT_EQ(hits[i].v, expected[i].v);
        ASSERT_EQ(occluded[i] != 0, expected[i].primitive != CLARAY_MISS);
    }
}

TEST_P(HighOnLayout, RefitAndRebuild) {
    const Mesh before = hall(2000);
    Mesh after = before;
    for (glm::vec3& p : after.positions) p = glm::vec3(p.y, -p.x, p.z) + 0.3f * glm::sin(5.f * p);
    Bvh bvh = build_high(before, GetParam());
    const std::string hash = bvh.hash();
    const auto move_to = [&](const Mesh& mesh) {
        std::vector<float> flat;
        for (const glm::vec3& p : mesh.positions) flat.insert(flat.end(), {p.x, p.y, p.z});
        Buffer<float> positions = bvh.triangles().positions;
        positions.write(flat);
    };
    move_to(after);
    bvh.refit();
    const std::vector<Ray> rays = random_rays(5003, 4.f, 1.f, 2);
    EXPECT_EQ(compare(closest_hit(bvh, rays), Oracle(std::span(&after, 1)).closest_hits(rays)).wrong, 0u);
    bvh.rebuild();
    EXPECT_EQ(bvh.hash(), build_high(after, GetParam()).hash());
    move_to(before);
    bvh.rebuild();
    EXPECT_EQ(bvh.hash(), hash);
}

INSTANTIATE_TEST_SUITE_P(Layouts, HighOnLayout, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

TEST(High, RefusesOtherLeavesAndBudgets) {
    const Mesh mesh = grid(2);
    for (const unsigned leaf : {0u, 5u})
        EXPECT_THROW((void)Bvh::build(device(), std::span(&mesh, 1), {.max_leaf_triangles = leaf}), Error);
    EXPECT_THROW((void)build_high(mesh, -1.0), Error);
    EXPECT_THROW((void)build_high(mesh, std::nan("")), Error);
}

TEST(High, IsSavedAndLoadedWithItsSettings) {
    const Mesh mesh = hall(500);
    const TemporaryFolder folder;
    Bvh::Config config;
    config.builder = Builder::high;
    config.layout = Layout::binary;
    config.split_budget = 0.23;
    for (const unsigned leaf : {1u, 4u}) {
        config.max_leaf_triangles = leaf;
        const Bvh saved = Bvh::build(device(), std::span(&mesh, 1), config);
        saved.save(folder / "high.cbvh");
        Bvh loaded = Bvh::load(device(), folder / "high.cbvh", Layout::binary);
        EXPECT_EQ(loaded.hash(), saved.hash());
        loaded.rebuild();
        EXPECT_EQ(loaded.hash(), saved.hash());
        const Bvh wide = Bvh::load(device(), folder / "high.cbvh", Layout::wide);  // has leaves of its own
        expect_valid(wide);
        const std::vector<Ray> rays = random_rays(2003, 4.f, 1.f, 5);
        const std::vector<Hit> hits = closest_hit(wide, rays), expected = closest_hit(saved, rays);
        for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(hits[i].primitive, expected[i].primitive) << "ray " << i;
    }
}

TEST(High, FitsTheStackOfATraversal) {
    Bvh bvh = build_high(doubling_triangles());
    expect_valid(bvh);
    EXPECT_LE(state_of(bvh).read_header().height, unsigned(CLARAY_MAX_HEIGHT));
    const std::string hash = bvh.hash();
    bvh.rebuild();
    EXPECT_EQ(bvh.hash(), hash);
}

/// A copy in traversal order: first children follow their node, leaves go from left to right.
TEST(High, LiesInMemoryAsItIsTraversed) {
    const Bvh bvh = build_high(hall(3000));
    const std::vector<BvhNode> nodes = state_of(bvh).nodes.read();
    std::vector<std::uint32_t> stack = {state_of(bvh).read_header().root};
    std::uint32_t next_node = 0, next_leaf = 0;
    while (!stack.empty()) {
        const std::uint32_t child = stack.back();
        stack.pop_back();
        if (child & CLARAY_LEAF) {
            ASSERT_EQ(child & CLARAY_SLOT, next_leaf++);
            continue;
        }
        ASSERT_EQ(child, next_node++);
        stack.push_back(nodes[child].child1);
        stack.push_back(nodes[child].child0);
    }
    EXPECT_EQ(next_leaf, state_of(bvh).read_header().valid);
    EXPECT_EQ(next_node + 1, next_leaf);
}

TEST(Builders, AutomaticIsWhatTheTuningTableSays) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    const Mesh mesh = soup(500, 0.3f, 7);
    std::set<std::string> hashes;
    for (unsigned i = 0; i < std::size(builders); ++i) {
        fresh.set_tuning("bvh/automatic", "BUILDER", i);
        EXPECT_EQ(resolve(Builder::automatic, fresh), builders[i].builder);
        const std::string hash = Bvh::build(fresh, std::span(&mesh, 1)).hash();
        EXPECT_EQ(hash, Bvh::build(fresh, std::span(&mesh, 1), {.builder = builders[i].builder}).hash());
        hashes.insert(hash);
    }
    EXPECT_GE(hashes.size(), 3u) << "high splits nothing here, as binned";
}

}  // namespace
}  // namespace claray::test
