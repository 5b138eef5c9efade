// The nearest point: trace/points/nearest_point.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "claray/query/points.hpp"
#include "tests/oracle/nearest.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

class NearestPointTest : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(const Mesh& mesh, Builder builder = Builder::fast) {
        return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .layout = GetParam()});
    }
};

Mesh mesh_of_one() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

std::vector<glm::vec3> random_points(std::size_t count, float half, std::uint64_t seed) {
    Random random(seed);
    std::vector<glm::vec3> points(count);
    for (glm::vec3& point : points) point = random.in_cube(half);
    return points;
}

/// Vertices, middles of edges and of triangles, and points just above these.
std::vector<glm::vec3> points_on(const Mesh& mesh) {
    std::vector<glm::vec3> points = mesh.positions;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        points.insert(points.end(), {0.5f * (a + b), (a + b + c) / 3.f, 0.5f * (b + c) + 1e-4f * glm::vec3(1, 2, 3)});
    }
    return points;
}

void expect_nearest(const Bvh& bvh, const Mesh& mesh, const std::vector<glm::vec3>& points,
                    const PointOptions& options = {}) {
    if (!device().info().fp64) GTEST_SKIP() << "distances are exact with float64 only";
    const NearestOracle oracle(mesh);
    const std::vector<NearestPoint> found = nearest_point(bvh, points, options);
    ASSERT_EQ(found.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_STREQ(oracle.judge(points[i], found[i], options.reach), "") << "point " << i;
}

bool same(const std::vector<NearestPoint>& a, const std::vector<NearestPoint>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST_P(NearestPointTest, OfSoupEqualsTheOracle) {
    const Mesh mesh = soup(1003, 0.1f, 1);
    expect_nearest(build(mesh), mesh, random_points(1501, 1.5f, 2));
    expect_nearest(build(mesh), mesh, random_points(301, 1.5f, 3), {.reach = 0.05f});
}

TEST_P(NearestPointTest, OfASphereEqualsTheOracle) {
    const Mesh mesh = sphere(3);
    expect_nearest(build(mesh), mesh, random_points(1003, 1.5f, 4));
    expect_nearest(build(mesh), mesh, {{0, 0, 0}, {0, 0, 1e-6f}, {1e3f, 0, 0}, {-1e6f, 3e5f, 2.f}});
    expect_nearest(build(sphere(2)), sphere(2), points_on(sphere(2)));
}

TEST_P(NearestPointTest, OfHugeAndTinyMeshesEqualsTheOracle) {
    Mesh far = sphere(2);
    verify::move_away(far);
    std::vector<glm::vec3> points = points_on(far);
    for (const glm::vec3& p : random_points(200, 3e6f, 5)) points.push_back(p);
    expect_nearest(build(far), far, points);
    Mesh tiny = sphere(2, 1e-20f);
    expect_nearest(build(tiny), tiny, random_points(300, 2e-20f, 6));
    expect_nearest(build(tiny), tiny, points_on(tiny));
    Mesh large = sphere(2, 1e17f);
    expect_nearest(build(large), large, random_points(300, 3e17f, 7));
    const std::vector<NearestPoint> beyond =
        nearest_point(build(mesh_of_one()), std::vector<glm::vec3>{{1e30f, 0, 0}, {3e38f, 3e38f, 3e38f}}, {});
    EXPECT_EQ(beyond[0].primitive, 0u);
    EXPECT_EQ(beyond[0].distance, 1e30f);
    EXPECT_EQ(beyond[1].primitive, 0u);
    EXPECT_EQ(beyond[1].distance, infinity);  // it is, in float32
}

TEST_P(NearestPointTest, OfSliversEqualsTheOracle) {
    Random random(8);
    Mesh mesh;
    for (std::uint32_t i = 0; i < 300; ++i) {  // thin, and some without area though no two vertices are equal
        const glm::vec3 a = random.in_cube(1), e = random.in_cube(1);
        const float thin = i % 3 == 0 ? 0.f : std::ldexp(1.f, -int(random.below(24)));
        mesh.positions.insert(mesh.positions.end(), {a, a + e, a + 0.5f * e + thin * random.in_cube(1)});
        mesh.triangles.push_back(3 * i + glm::uvec3(0, 1, 2));
    }
    expect_nearest(build(mesh), mesh, random_points(1001, 1.2f, 9));
    expect_nearest(build(mesh), mesh, points_on(mesh));
}

TEST_P(NearestPointTest, DoesNotDependOnTheTree) {
    Mesh mesh = soup(4001, 0.3f, 10);
    for (std::uint32_t i = 0; i < 100; ++i) mesh.triangles.push_back(mesh.triangles[7 * i]);  // equal distances
    std::vector<glm::vec3> points = random_points(5003, 1.2f, 11);
    points.insert(points.end(), mesh.positions.begin(), mesh.positions.begin() + 1000);
    const std::vector<NearestPoint> here = nearest_point(build(mesh), points);
    EXPECT_TRUE(same(here, nearest_point(build(mesh, Builder::high), points)));
    EXPECT_TRUE(same(here, nearest_point(build(mesh, Builder::balanced), points, {.sort = false})));
    const Bvh binary = Bvh::build(device(), std::span(&mesh, 1), {.layout = Layout::binary});
    EXPECT_TRUE(same(here, nearest_point(binary, points)));
    EXPECT_TRUE(same(here, nearest_point(binary, points, {.brute_force = true})));
}

TEST_P(NearestPointTest, FindsFewAndNoTriangles) {
    const std::vector<glm::vec3> points = {{0.25f, 0.25f, 2}, {-1, 0, 0}, {0, 0, 0}};
    EXPECT_EQ(nearest_point(build(Mesh{}), points)[0].primitive, CLARAY_MISS);
    EXPECT_EQ(nearest_point(build(Mesh{}), points)[0].distance, infinity);
    expect_nearest(build(mesh_of_one()), mesh_of_one(), points);
    expect_nearest(build(grid(1)), grid(1), points);
    EXPECT_TRUE(nearest_point(build(grid(1)), std::vector<glm::vec3>{}).empty());
    Mesh culled = mesh_of_one();
    culled.positions.push_back({0, 0, nan});
    culled.triangles = {{0, 0, 1}, {0, 1, 3}, {0, 1, 2}};
    EXPECT_EQ(nearest_point(build(culled), points)[0].primitive, 2u);
}

TEST_P(NearestPointTest, ReachIsInclusive) {
    const std::vector<glm::vec3> point = {{0.25f, 0.25f, 2}};
    const auto found = [&](float reach) { return nearest_point(build(mesh_of_one()), point, {.reach = reach})[0]; };
    EXPECT_EQ(found(2.f).primitive, 0u);
    EXPECT_EQ(found(2.f).distance, 2.f);
    EXPECT_EQ(found(2.f).u, 0.25f);
    EXPECT_EQ(found(std::nextafter(2.f, 0.f)).primitive, CLARAY_MISS);
    EXPECT_EQ(found(std::nextafter(2.f, 0.f)).x, 0.25f);
    EXPECT_EQ(found(-1.f).primitive, CLARAY_MISS);
    EXPECT_EQ(found(nan).primitive, CLARAY_MISS);
}

TEST_P(NearestPointTest, OfPointsThatAreNotFiniteIsNothing) {
    const std::vector<glm::vec3> points = {{nan, 0, 0}, {0, infinity, 0}, {0, 0, -infinity}, {0.25f, 0.25f, 1}};
    const std::vector<NearestPoint> found = nearest_point(build(mesh_of_one()), points);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(found[i].primitive, CLARAY_MISS);
    EXPECT_EQ(found[3].primitive, 0u);
}

TEST_P(NearestPointTest, SeesMeshesOfItsMask) {
    std::vector<Mesh> meshes = {grid(2), verify::translated(grid(2), {0, 0, 1})};
    meshes[0].mask = 1, meshes[1].mask = 2;
    const Bvh bvh = Bvh::build(device(), meshes, {.layout = GetParam()});
    const std::vector<glm::vec3> points(4, {0.3f, 0.4f, 0.1f});
    const std::vector<NearestPoint> found =
        nearest_point(bvh, points, {.masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{1, 2, 3, 4})});
    EXPECT_EQ(found[0].geometry, 0u);
    EXPECT_EQ(found[1].geometry, 1u);
    EXPECT_FLOAT_EQ(found[1].distance, 0.9f);
    EXPECT_EQ(found[2].geometry, 0u);
    EXPECT_EQ(found[3].primitive, CLARAY_MISS);
}

TEST_P(NearestPointTest, VisitsFewTriangles) {
    const Mesh mesh = sphere(5);  // 20,480 triangles
    const std::vector<glm::vec3> points = random_points(500, 1.5f, 12);
    const PointOptions options{.visits = Buffer<Visits>(device(), points.size())};
    (void)nearest_point(build(mesh), points, options);
    double triangles = 0;
    for (const Visits& visits : options.visits.read()) triangles += visits.triangles;
    EXPECT_LT(triangles / double(points.size()), 300);
}

TEST_P(NearestPointTest, RefusesBuffersOfOtherSizes) {
    const Bvh bvh = build(mesh_of_one());
    Buffer<NearestPoint> one(device(), 1), none(device(), 0);
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "3 floats", [&] { nearest_point(bvh, Buffer<float>(device(), 4), one); }));
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "answers", [&] { nearest_point(bvh, Buffer<float>(device(), 3), none); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "masks", [&] {
        nearest_point(bvh, Buffer<float>(device(), 3), one, {.masks = Buffer<std::uint32_t>(device(), 0)});
    }));
}

INSTANTIATE_TEST_SUITE_P(Layouts, NearestPointTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "Wide" : "Binary"; });

}  // namespace
}  // namespace claray::test
