// Whether triangles close: bvh/validate.cl.
#include <gtest/gtest.h>

#include <limits>

#include "claray/bvh.hpp"
#include "claray/primitives/primitives.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

Bvh of_mesh(const Mesh& mesh) { return Bvh::build(device(), std::span(&mesh, 1)); }
bool is_closed(const Mesh& mesh) { return is_closed(of_mesh(mesh)); }

/// Each triangle with vertices of its own.
Mesh unshared(const Mesh& mesh) {
    Mesh soup;
    for (const glm::uvec3& t : mesh.triangles) {
        const auto first = std::uint32_t(soup.positions.size());
        for (int k = 0; k < 3; ++k) soup.positions.push_back(mesh.positions[t[k]]);
        soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    return soup;
}

Mesh both_of(Mesh mesh, const Mesh& other) {
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(first + t);
    return mesh;
}

TEST(Closed, SurfacesWithoutBordersAre) {
    EXPECT_TRUE(is_closed(sphere(3)));
    EXPECT_TRUE(is_closed(unshared(sphere(3))));
    EXPECT_TRUE(is_closed(both_of(sphere(2), sphere(2, 0.5f))));
    EXPECT_TRUE(is_closed(both_of(grid(5), grid(5)))) << "both sides of a sheet contain nothing";
    EXPECT_FALSE(is_closed(grid(5)));
}

TEST(Closed, EveryMissingTriangleOpens) {
    const Mesh whole = sphere(1);
    for (std::size_t i = 0; i < whole.triangles.size(); ++i) {
        Mesh open = whole;
        open.triangles.erase(open.triangles.begin() + std::ptrdiff_t(i));
        ASSERT_FALSE(is_closed(open)) << i;
    }
}

TEST(Closed, TrianglesWithoutAreaChangeNothingAndThoseThatAreNotFiniteOpen) {
    Mesh mesh = sphere(2);
    mesh.triangles.emplace_back(0, 0, 1);
    EXPECT_TRUE(is_closed(mesh));
    mesh.positions[mesh.triangles[7].x].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(is_closed(mesh));
}

TEST(Closed, ZerosOfBothSignsAreTheSamePlace) {
    Mesh mesh = unshared(both_of(grid(2), grid(2)));
    bool negative = false;
    for (glm::vec3& p : mesh.positions)
        for (int k = 0; k < 3; ++k)
            if (p[k] == 0) p[k] = (negative = !negative) ? -0.f : 0.f;
    EXPECT_TRUE(is_closed(mesh));
}

TEST(Closed, FollowsMovedVertices) {
    const Mesh mesh = unshared(sphere(2));
    Bvh bvh = of_mesh(mesh);
    EXPECT_TRUE(is_closed(bvh));
    Buffer<float> positions = bvh.triangles().positions;
    const float moved = mesh.positions[4].x + 0.5f, before = mesh.positions[4].x;
    positions.write(std::span(&moved, 1), 12);
    bvh.refit();
    EXPECT_FALSE(is_closed(bvh));
    positions.write(std::span(&before, 1), 12);
    bvh.rebuild();
    EXPECT_TRUE(is_closed(bvh));
}

TEST(Closed, PrimitivesHaveNoEdges) {
    const std::vector<float> spheres = {0, 0, 0, 1};
    const Primitives primitives = Primitives::build(device(), sphere_kind(), spheres);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "needs a tree of triangles",
                             [&] { static_cast<void>(is_closed(primitives.bvh())); }));
}

}  // namespace
}  // namespace claray::test
