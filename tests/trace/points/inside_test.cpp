// Points inside of closed meshes: trace/points/crossings.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "claray/query/points.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

__extension__ using Quad = __float128;  // holds the determinants of these tests without rounding

class InsideTest : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(const Mesh& mesh, Builder builder = Builder::fast) {
        return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .layout = GetParam()});
    }
};

/// Of a convex mesh: 1 inside, 0 on the surface, -1 outside; without rounding.
int side_of_convex(const Mesh& mesh, const glm::vec3& p) {
    int side = 1;
    for (const glm::uvec3& t : mesh.triangles) {
        Quad m[3][3];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) m[i][j] = Quad(mesh.positions[t[i]][j]) - Quad(p[j]);
        const Quad det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
        side = std::min(side, det > 0 ? 1 : det < 0 ? -1 : 0);
    }
    return side;
}

void expect_inside_of_convex(const Bvh& bvh, const Mesh& mesh, const std::vector<glm::vec3>& points) {
    if (!device().info().fp64) GTEST_SKIP() << "parities are exact with float64 only";
    const std::vector<std::uint8_t> found = inside(bvh, points);
    std::size_t in = 0, out = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const int side = side_of_convex(mesh, points[i]);
        if (side == 0) continue;
        ASSERT_EQ(found[i] != 0, side > 0) << i;
        ++(side > 0 ? in : out);
    }
    EXPECT_GT(in, points.size() / 10);
    EXPECT_GT(out, points.size() / 10);
}

TEST_P(InsideTest, OfAConvexMeshIsExact) {
    const Mesh mesh = sphere(2);
    Random random(1);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 1000; ++i) points.push_back(random.in_cube(1.2f));
    for (const Builder builder : {Builder::fast, Builder::high})
        expect_inside_of_convex(build(mesh, builder), mesh, points);
}

/// Floats next to vertices, edges and faces, and on the vertical lines through them.
TEST_P(InsideTest, NextToTheSurfaceIsExact) {
    const Mesh mesh = sphere(2);
    std::vector<glm::vec3> points;
    Random random(2);
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        for (const glm::vec3& p : {a, 0.5f * (a + b), (a + b + c) / 3.f}) {
            for (const float far : {-2.f, 2.f}) {
                glm::vec3 q = p;
                const int axis = int(random.below(3));
                // A denormal number would be lost in the differences, here and in the kernel.
                if (q[axis] != 0) q[axis] = std::nextafter(q[axis], far);
                points.push_back(q);
                q = p;
                if (q.z != 0) q.z = std::nextafter(q.z, far);
                points.push_back(q);
            }
            points.push_back({p.x, p.y, 0.1f * p.z});
        }
    }
    expect_inside_of_convex(build(mesh), mesh, points);
}

/// Triangles whose planes pass the origin so closely that float64 cannot tell on which side: determinants of 1 and -1,
/// the differences between the product of three numbers and 2^66.
TEST_P(InsideTest, IsExactBeyondFloat64) {
    if (!device().info().fp64) GTEST_SKIP() << "parities are exact with float64 only";
    const std::vector<glm::vec3> origin = {{0, 0, 0}};
    constexpr float side = 0x1p22f;
    for (const auto& [factors, above] : {std::pair(glm::vec3(4194305, 4065217, 4327489), true),
                                         std::pair(glm::vec3(8640387, 14245331, 599479), false)})
        for (const float up : {1.f, -1.f}) {
            Mesh mesh;
            mesh.positions = {{factors.x, -side, 0}, {0, factors.y, -side * up}, {-side, 0, factors.z * up}};
            mesh.triangles = {{0, 1, 2}};
            EXPECT_EQ(inside(build(mesh), origin)[0] != 0, above == (up > 0));
        }
}

/// A box of unit squares, whose points with whole coordinates are above vertices and edges.
TEST_P(InsideTest, OnALatticeIsExact) {
    Mesh cube;
    constexpr int n = 4;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const Mesh square = grid(n);
            const auto first = std::uint32_t(cube.positions.size());
            for (const glm::vec3& p : square.positions) {
                glm::vec3 q;
                q[axis] = float(side * n), q[(axis + 1) % 3] = p.x * n, q[(axis + 2) % 3] = p.y * n;
                cube.positions.push_back(q);
            }
            for (const glm::uvec3& t : square.triangles)
                cube.triangles.push_back(first + (side == 1 ? t : glm::uvec3(t.x, t.z, t.y)));
        }
    std::vector<glm::vec3> points;
    for (int x = -1; x <= 2 * n + 1; ++x)
        for (int y = -1; y <= 2 * n + 1; ++y)
            for (int z = -1; z <= 2 * n + 1; ++z) points.push_back(0.5f * glm::vec3(x, y, z));
    const std::vector<std::uint8_t> found = inside(build(cube), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::vec3 p = points[i];
        const float least = std::min({p.x, p.y, p.z}), most = std::max({p.x, p.y, p.z});
        if (least < 0 || most > n) {
            ASSERT_EQ(found[i], 0) << p.x << " " << p.y << " " << p.z;
        }
        if (least > 0 && most < n) {
            ASSERT_EQ(found[i], 1) << p.x << " " << p.y << " " << p.z;
        }
    }
}

TEST_P(InsideTest, CountsShellsByParity) {
    Mesh shells = sphere(3);
    const Mesh inner = sphere(2, 0.5f);
    const auto first = std::uint32_t(shells.positions.size());
    shells.positions.insert(shells.positions.end(), inner.positions.begin(), inner.positions.end());
    for (const glm::uvec3& t : inner.triangles) shells.triangles.push_back(t + first);
    const std::vector<glm::vec3> points = {{0, 0, 0}, {0, 0, 0.7f}, {0, 0, -0.7f}, {0, 0, 2}, {0, 0, -2}};
    for (const Builder builder : {Builder::fast, Builder::high})
        EXPECT_EQ(inside(build(shells, builder), points), (std::vector<std::uint8_t>{0, 1, 1, 0, 0}));
}

TEST_P(InsideTest, SignsDistances) {
    const Bvh bvh = build(sphere(4));
    const std::vector<glm::vec3> points = {{0, 0, 0.5f}, {0, 0, 3}, {0, 0, 9}};
    const std::vector<float> distances = signed_distance(bvh, points, {.reach = 4.f});
    EXPECT_NEAR(distances[0], -0.5f, 2e-3f);
    EXPECT_NEAR(distances[1], 2.f, 2e-3f);
    EXPECT_EQ(distances[2], 4.f);
}

/// A ball without its top: upwards, rays leave through the hole.
TEST_P(InsideTest, MostRaysDecideWhereTheMeshIsOpen) {
    Mesh bowl = sphere(3);
    std::erase_if(bowl.triangles, [&](const glm::uvec3& t) { return bowl.positions[t.x].z > 0.8f; });
    const Bvh bvh = build(bowl);
    const std::vector<glm::vec3> points = {{0, 0, 0}, {0.2f, 0.1f, -0.3f}, {0, 0, 3}, {1.1f, 0, 0}};
    const PointOptions vote = {.vote = true};
    EXPECT_EQ(inside(bvh, points), (std::vector<std::uint8_t>{0, 0, 0, 0}));
    EXPECT_EQ(inside(bvh, points, vote), (std::vector<std::uint8_t>{1, 1, 0, 0}));
    const std::vector<float> by_vote = signed_distance(bvh, points, vote), by_one = signed_distance(bvh, points);
    EXPECT_LT(by_vote[0], 0);
    EXPECT_EQ(by_vote[0], -by_one[0]);
    EXPECT_EQ(by_vote[2], by_one[2]);
}

TEST_P(InsideTest, ASheetContainsNothingByVote) {
    const Bvh bvh = build(grid(8));
    const std::vector<glm::vec3> points = {{0.4f, 0.3f, -0.1f}, {0.4f, 0.3f, -1e-4f}, {0.4f, 0.3f, 1e-4f}};
    EXPECT_EQ(inside(bvh, points), (std::vector<std::uint8_t>{1, 1, 0}));
    EXPECT_EQ(inside(bvh, points, {.vote = true}), (std::vector<std::uint8_t>{0, 0, 0}));
}

TEST_P(InsideTest, OneRayDecidesForClosedMeshesInAnyCase) {
    const Bvh bvh = build(sphere(2));
    Random random(5);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 300; ++i) points.push_back(random.in_cube(1.2f));
    EXPECT_EQ(inside(bvh, points, {.vote = true}), inside(bvh, points));
}

TEST_P(InsideTest, IsNothingWithoutPointsOrMesh) {
    EXPECT_TRUE(inside(build(sphere(1)), std::vector<glm::vec3>{}).empty());
    EXPECT_EQ(inside(build(Mesh{}), std::vector<glm::vec3>{{0, 0, 0}})[0], 0);
    EXPECT_EQ(inside(build(sphere(1)),
                     std::vector<glm::vec3>{{0, 0, nan}, {nan, 0, 0}, {0, 0, -infinity}, {infinity, 0, 0}, {0, 0, 0}}),
              (std::vector<std::uint8_t>{0, 0, 0, 0, 1}));
    Buffer<std::uint8_t> none(device(), 0);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "1 points",
                             [&] { inside(build(sphere(1)), Buffer<float>(device(), 3), none); }));
}

INSTANTIATE_TEST_SUITE_P(Layouts, InsideTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::wide ? "Wide" : "Binary"; });

}  // namespace
}  // namespace claray::test
