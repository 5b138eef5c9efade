// Geometry that `claray verify` does not test: closed meshes from outside, hits on lattices bit for bit, borders.
#include <gtest/gtest.h>

#include <cmath>

#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/query.hpp"
#include "tests/verify/edge_rays.hpp"

namespace claray::test {
namespace {

class HardCase : public testing::TestWithParam<Layout> {
protected:
    static Bvh build(const Mesh& mesh) { return Bvh::build(device(), std::span(&mesh, 1), {.layout = GetParam()}); }
};

/// How many triangles claim each ray, without the tree.
std::vector<std::uint32_t> count_claims(const Bvh& bvh, const std::vector<Ray>& rays) {
    const Buffer<Ray> device_rays(device(), rays);
    Buffer<std::uint32_t> counts(device(), rays.size());
    load_kernel(device(), "verify/count_claims.cl", "count_claims")
        .run({rays.size(), 64}, state_of(bvh).header, state_of(bvh).nodes, state_of(bvh).leaves, device_rays,
             std::uint32_t(rays.size()), counts);
    return counts.read();
}

TEST_P(HardCase, ClosedMeshesAreLeftAsOftenAsEntered) {
    const Mesh mesh = sphere(3);
    const Bvh bvh = build(mesh);
    const std::vector<Ray> rays = rays_at_edges(corners_of(mesh), glm::vec3(0, 0, 4), 1.f, 20'000, 2);
    for (const std::uint32_t claims : count_claims(bvh, rays)) ASSERT_EQ(claims % 2, 0u);
}

/// A prism that lies askew, with sides of two long triangles each: a builder that splits triangles puts them into
/// several leaves.
Mesh skew_prism(unsigned sides) {
    Mesh mesh;
    const glm::vec3 axis = glm::normalize(glm::vec3(1, 2, 3)), u = glm::normalize(glm::cross(axis, glm::vec3(1, 0, 0)));
    const glm::vec3 v = glm::cross(axis, u);
    for (unsigned i = 0; i < sides; ++i) {
        const float angle = 6.2831853f * float(i) / float(sides);
        for (const float end : {-1.f, 1.f})
            mesh.positions.push_back(end * axis + 0.2f * (std::cos(angle) * u + std::sin(angle) * v));
        const unsigned a = 2 * i, b = 2 * ((i + 1) % sides);
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + 1}, {a, b + 1, a + 1}});
        if (i > 1) mesh.triangles.insert(mesh.triangles.end(), {{0, a, a - 2}, {1, a - 1, a + 1}});
    }
    return mesh;
}

TEST_P(HardCase, TrianglesInSeveralLeavesClaimARayOnce) {
    const Mesh mesh = skew_prism(64);
    const Bvh bvh = Bvh::build(device(), std::span(&mesh, 1), {.builder = Builder::high, .layout = GetParam()});
    ASSERT_GT(bvh.statistics().references, 64u) << "the builder splits none of these triangles";
    const std::vector<Ray> rays = rays_at_edges(corners_of(mesh), glm::vec3(0), 0.02f, 20'000, 5);
    for (const std::uint32_t claims : count_claims(bvh, rays)) ASSERT_EQ(claims, 1u);
}

TEST_P(HardCase, AxisParallelRaysOnBoxFacesEqualTheOracle) {
    Mesh mesh = soup(400, 0.3f, 21);
    for (glm::vec3& p : mesh.positions) p = glm::round(p * 8.f) / 8.f;  // box faces on a lattice
    const Bvh bvh = build(mesh);
    Random random(22);
    std::vector<Ray> rays;
    for (int i = 0; i < 30'000; ++i) {
        const glm::vec3 vertex = mesh.positions[random.below(std::uint32_t(mesh.positions.size()))];
        const glm::vec3 other = mesh.positions[random.below(std::uint32_t(mesh.positions.size()))];
        const int axis = i % 3;
        glm::vec3 origin = vertex, direction(0.f);
        origin[(axis + 1) % 3] = other[(axis + 1) % 3] + (i % 2 ? random.uniform(-0.1f, 0.1f) : 0.f);
        origin[axis] = i % 4 < 2 ? -3.f : 3.f;
        direction[axis] = i % 4 < 2 ? 1.f : -1.f;
        if (i % 5 == 0) direction[(axis + 1) % 3] = -0.f;
        rays.push_back(make_ray(origin, direction));
    }
    // On a lattice rays graze edges exactly, where inclusive tests claim what a tie rule gives to the neighbour or to
    // nobody: the reference is the same exact test over every triangle.
    const std::vector<Hit> fast = closest_hit(bvh, rays), slow = closest_hit(bvh, rays, brute_force);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(fast[i].primitive, slow[i].primitive) << i;
        ASSERT_EQ(fast[i].t, slow[i].t) << i;
        hits += fast[i].primitive != CLARAY_MISS;
    }
    EXPECT_GT(hits, 3000u);
}

/// Half-open as in rasterisation: of a lone square, rays through its border hit two sides of the four.
TEST_P(HardCase, TheBorderOfAnOpenMeshIsHalfOpen) {
    const Bvh bvh = build(grid(1));
    std::vector<Ray> rays;
    for (const glm::vec3 at :
         {glm::vec3(0, 0.25f, 1), glm::vec3(1, 0.25f, 1), glm::vec3(0.25f, 0, 1), glm::vec3(0.25f, 1, 1)})
        rays.push_back(make_ray(at, {0, 0, -1}));
    std::size_t hits = 0;
    for (const Hit& hit : closest_hit(bvh, rays)) hits += hit.primitive != CLARAY_MISS;
    EXPECT_EQ(hits, 2u);
}

INSTANTIATE_TEST_SUITE_P(Layouts, HardCase, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

}  // namespace
}  // namespace claray::test
