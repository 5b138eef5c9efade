// Rays that break instancing: along silhouettes, through edges of rotated objects, from far away, between duplicates.
#include "claray/instances.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/oracle/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/query.hpp"
#include "tests/verify/edge_rays.hpp"

namespace claray::test {
namespace {

class HardInstances : public testing::TestWithParam<Layout> {
protected:
    static InstancedBvh build(std::span<const Mesh> meshes, std::span<const Instance> instances) {
        return InstancedBvh::build(build_bottoms(meshes, GetParam()), instances);
    }
};

/// A cube of half side 1: its silhouette is that of its box, so nothing is to spare.
Mesh cube() {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    for (const glm::uvec4 f : {glm::uvec4(0, 4, 6, 2), glm::uvec4(1, 3, 7, 5), glm::uvec4(0, 1, 5, 4),
                               glm::uvec4(2, 6, 7, 3), glm::uvec4(0, 2, 3, 1), glm::uvec4(4, 5, 7, 6)}) {
        mesh.triangles.emplace_back(f.x, f.y, f.z);
        mesh.triangles.emplace_back(f.x, f.z, f.w);
    }
    return mesh;
}

/// The hits with the top level and without must be the same to the bit. Returns how many there are.
std::size_t expect_nothing_lost(const InstancedBvh& bvh, const std::vector<Ray>& rays) {
    const std::vector<InstanceHit> fast = closest_hit(bvh, rays), slow = closest_hit(bvh, rays, brute_force);
    std::size_t hits = 0, lost = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        lost += !same(fast[i], slow[i]);
        hits += slow[i].primitive != CLARAY_MISS;
    }
    EXPECT_EQ(lost, 0u) << "of " << hits;
    return hits;
}

TEST_P(HardInstances, NoRayLeaksOutOfAnObject) {
    const std::vector<Mesh> meshes = {sphere(2)};
    for (const glm::vec3 offset : {glm::vec3(0), glm::vec3(148376, 1234, -223423), glm::vec3(1e6f)}) {
        std::vector<Instance> instances = random_instances(1, 1, 0.f, 50.f, 1);
        instances[0].row0[3] = offset.x, instances[0].row1[3] = offset.y, instances[0].row2[3] = offset.z;
        const InstancedBvh bvh = build(meshes, instances);
        std::size_t missed = 0;
        for (const InstanceHit& hit :
             closest_hit(bvh, rays_at_edges(world_corners(meshes, instances), offset, 5.f, 50'000, 2)))
            missed += hit.primitive == CLARAY_MISS;
        EXPECT_EQ(missed, 0u) << "offset " << offset.x;
    }
}

/// Rays that graze cubes along their edges, where the boxes of the top level have nothing to spare but what they grow
/// by.
TEST_P(HardInstances, TheTopLevelLosesNothingAlongSilhouettes) {
    const std::vector<Mesh> meshes = {cube()};
    for (const float offset : {0.f, 3e3f, 1e6f}) {
        std::vector<Instance> instances;
        Random random(3);
        for (int i = 0; i < 60; ++i) {
            const glm::vec3 at = offset * glm::vec3(1, -0.7f, 0.3f) + random.in_cube(20.f);
            glm::mat4 m = glm::translate(glm::mat4(1.f), at);
            if (i % 3 == 1) m = m * random_rotation(random);
            if (i % 3 == 2) m = glm::scale(m, glm::vec3(1, random.uniform(0.01f, 2.f), 3)) * random_rotation(random);
            instances.push_back(make_instance(m));
        }
        const InstancedBvh bvh = build(meshes, instances);
        const std::vector<glm::dvec3> corners = world_corners(meshes, instances);
        const glm::vec3 middle = offset * glm::vec3(1, -0.7f, 0.3f);
        std::size_t hits = 0;
        for (const float distance : {30.f, 1e3f, 1e5f})
            hits += expect_nothing_lost(
                bvh, rays_at_edges(corners, middle + glm::vec3(0, 0, distance), distance * 0.9f, 15'000, 4));
        EXPECT_GT(hits, 10'000u);
    }
}

/// Transforms at the limit of float32: the boxes grow by the error of such rays.
TEST_P(HardInstances, TheTopLevelLosesNothingOfFlattenedObjects) {
    const std::vector<Mesh> meshes = {cube(), grid(4)};
    std::vector<Instance> instances;
    Random random(5);
    for (std::uint32_t i = 0; i < 60; ++i) {
        const float thin = std::exp2(-float(random.below(16)));
        const glm::mat4 m = glm::translate(glm::mat4(1.f), random.in_cube(20.f)) *
                            glm::scale(glm::mat4(1.f), glm::vec3(1, thin, 2)) * random_rotation(random);
        instances.push_back(make_instance(m, i % 2));
    }
    const InstancedBvh bvh = build(meshes, instances);
    EXPECT_EQ(bvh.statistics().culled, 0u);
    EXPECT_GT(bvh.statistics().widening, 1e-3f);
    const std::vector<glm::dvec3> corners = world_corners(meshes, instances);
    for (const float distance : {50.f, 5e3f}) {  // from afar by far more than the objects' size
        const std::vector<Ray> rays =
            rays_at_edges(corners, glm::vec3(0, distance, distance), 0.6f * distance, 20'000, 6);
        EXPECT_GT(expect_nothing_lost(bvh, rays), 5000u);
    }
}

/// What a ray loses on its way into an object counts from the object's origin, however near the surface is.
TEST_P(HardInstances, TheTopLevelLosesNothingOfObjectsFarFromTheirOrigin) {
    const glm::vec3 away(5000, -3000, 2000);
    std::vector<Mesh> meshes = {cube()};
    for (glm::vec3& p : meshes[0].positions) p += away;
    std::vector<Instance> instances;
    Random random(22);
    for (int i = 0; i < 60; ++i)  // the silhouette of a cube along the axes is that of its box
        instances.push_back(make_instance(glm::translate(glm::mat4(1.f), random.in_cube(5.f) - away)));
    const InstancedBvh bvh = build(meshes, instances);
    const std::vector<glm::dvec3> corners = world_corners(meshes, instances);
    EXPECT_GT(expect_nothing_lost(bvh, rays_at_edges(corners, glm::vec3(0), 6.f, 40'000, 23)), 20'000u);
}

/// Flat boxes in the planes of the axes, and rays along them.
TEST_P(HardInstances, AxisParallelRaysAndFlatObjects) {
    const std::vector<Mesh> meshes = {grid(2), cube()};
    std::vector<Instance> instances;
    Random random(7);
    for (std::uint32_t i = 0; i < 90; ++i) {
        const glm::mat4 turned = i % 3 == 0   ? glm::mat4(1.f)
                                 : i % 3 == 1 ? glm::mat4(glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0),
                                                          glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 0, 1))
                                              : glm::scale(glm::mat4(1.f), glm::vec3(-1, 2, 0.5f));
        const glm::vec3 at = glm::round(random.in_cube(16.f)) * 0.5f;
        instances.push_back(make_instance(glm::translate(glm::mat4(1.f), at) * turned, i % 2));
    }
    const InstancedBvh bvh = build(meshes, instances);
    std::vector<Ray> rays;
    for (int i = 0; i < 30'000; ++i) {
        glm::vec3 origin = glm::round(random.in_cube(32.f)) * 0.25f, direction(0.f);
        direction[i % 3] = i % 2 ? 1.f : -1.f;
        if (i % 5 == 0) direction[(i + 1) % 3] = -0.f;
        origin[i % 3] = i % 2 ? -20.f : 20.f;
        rays.push_back(make_ray(origin, direction));
    }
    EXPECT_GT(expect_nothing_lost(bvh, rays), 3000u);
}

/// Signed permutations, powers of two and a lattice: float32 transforms such rays exactly, so that the hits are those
/// of the flattened scene.
TEST_P(HardInstances, ExactTransformsGiveTheHitsOfTheFlatScene) {
    Mesh ball = sphere(2);
    for (glm::vec3& p : ball.positions) p = glm::round(p * 32.f) / 32.f;
    const std::vector<Mesh> meshes = {ball};
    Random random(8);
    std::vector<Instance> instances;
    for (int i = 0; i < 40; ++i) {
        glm::mat4 m(0.f);
        for (int axis = 0; axis < 3; ++axis)
            m[axis][(axis + i) % 3] = std::exp2(float(random.below(4)) - 2.f) * (random.below(2) != 0 ? 1.f : -1.f);
        m[3] = glm::vec4(glm::round(random.in_cube(16.f)) / 2.f, 1.f);
        instances.push_back(make_instance(m));
    }
    Mesh flat;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> origin_of;  // instance and primitive
    const std::vector<glm::dvec3> corners = world_corners(meshes, instances);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const auto base = std::uint32_t(i), count = std::uint32_t(ball.triangles.size());
        for (int k = 0; k < 3; ++k) flat.positions.emplace_back(corners[i + std::size_t(k)]);
        flat.triangles.emplace_back(base, base + 1, base + 2);
        origin_of.emplace_back(base / 3 / count, base / 3 % count);
    }
    std::vector<Ray> rays;
    for (int i = 0; i < 60'000; ++i)
        rays.push_back(make_ray(glm::round(random.in_cube(1000.f)) / 64.f, glm::round(random.in_cube(1000.f)) / 64.f));
    const std::vector<InstanceHit> hits = closest_hit(build(meshes, instances), rays);
    const std::vector<Hit> expected = closest_hit(Bvh::build(device(), std::span(&flat, 1)), rays);
    std::size_t found = 0, ties = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].primitive == CLARAY_MISS, expected[i].primitive == CLARAY_MISS) << i;
        if (hits[i].primitive == CLARAY_MISS) continue;
        ++found;
        ASSERT_LE(hits[i].t, std::nextafter(expected[i].t, 1e30f)) << i;
        ASSERT_GE(hits[i].t, std::nextafter(expected[i].t, 0.f)) << i;
        ties += origin_of[expected[i].primitive] != std::pair(hits[i].instance, hits[i].primitive);
    }
    EXPECT_GT(found, 3000u);
    EXPECT_LT(ties, found / 100);  // rays through an edge, which the object's axes give to the other triangle
}

TEST_P(HardInstances, OfEqualInstancesTheFirstWins) {
    const std::vector<Mesh> meshes = {soup(20, 0.5f, 9)};
    const std::vector<Instance> base = random_instances(20, 1, 1.f, 0.5f, 10);
    const std::vector<Ray> rays = random_rays(3000, 4.f, 1.f, 11);
    const std::vector<InstanceHit> expected = closest_hit(build(meshes, base), rays);
    Random random(12);
    for (int shuffle = 0; shuffle < 5; ++shuffle) {
        std::vector<Instance> copies = base;
        for (int i = 0; i < 60; ++i) copies.push_back(base[random.below(20)]);
        const std::vector<InstanceHit> hits = closest_hit(build(meshes, copies), rays);
        for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(hits[i], expected[i])) << shuffle << ", " << i;
    }
}

TEST_P(HardInstances, ManyInOnePlace) {
    const std::vector<Mesh> meshes = {soup(3, 0.5f, 13)};
    const std::vector<Instance> instances(3001, random_instances(1, 1, 1.f, 0.5f, 14)[0]);
    const InstancedBvh bvh = build(meshes, instances);
    EXPECT_TRUE(bvh.validate().ok());
    EXPECT_LE(bvh.statistics().height, 12u);
    for (const InstanceHit& hit : closest_hit(bvh, random_rays(500, 4.f, 1.f, 15)))
        ASSERT_TRUE(hit.instance == 0 || hit.instance == CLARAY_MISS);
}

TEST_P(HardInstances, JunkAmongThemChangesNoHit) {
    const std::vector<Mesh> meshes = {soup(30, 0.5f, 16)};
    std::vector<Instance> instances = random_instances(200, 1, 2.f, 0.3f, 17);
    const std::vector<Ray> rays = random_rays(3000, 6.f, 2.f, 18);
    const std::vector<InstanceHit> expected = closest_hit(build(meshes, instances), rays);
    for (std::size_t i = 0; i < 20; ++i) {
        instances.push_back(instances[i]);
        (i % 4 == 0 ? instances.back().row0[3] : instances.back().row1[i % 3]) = i % 2 ? NAN : 1e30f;
    }
    const InstancedBvh bvh = build(meshes, instances);
    EXPECT_EQ(bvh.statistics().culled, 20u);
    const std::vector<InstanceHit> hits = closest_hit(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(hits[i], expected[i])) << i;
}

/// Objects a thousand kilometres from the world's origin, seen from nearby, and tiny ones: precision is relative to the
/// distance between ray and object, not to coordinates.
TEST_P(HardInstances, HugeOffsetsAndTinyScalesEqualTheOracle) {
    const std::vector<Mesh> meshes = {soup(100, 0.3f, 19)};
    for (const auto& [offset, scale] : {std::pair(1e6f, 20.f), std::pair(148376.f, 5.f), std::pair(0.f, 1e-6f)}) {
        std::vector<Instance> instances = random_instances(30, 1, 4.f * scale, scale, 20);
        for (Instance& i : instances) i.row0[3] += offset, i.row1[3] += offset, i.row2[3] += offset;
        std::vector<Ray> rays = random_rays(5003, 12.f, 4.f, 21);
        for (Ray& r : rays) r.ox = r.ox * scale + offset, r.oy = r.oy * scale + offset, r.oz = r.oz * scale + offset;
        const InstanceComparison c =
            InstanceOracle(meshes, instances).compare(rays, closest_hit(build(meshes, instances), rays));
        EXPECT_GT(c.hits, 500u);
        EXPECT_EQ(c.wrong, 0u) << offset << ", " << scale;
        EXPECT_LT(c.marginal, c.rays / 500);
    }
}

TEST_P(HardInstances, RaysThatAreNoRaysHitNothing) {
    const InstancedBvh bvh = build(std::vector{sphere(1)}, std::vector{make_instance(glm::mat4(1.f))});
    const glm::vec3 o(0, 0, 3), d(0, 0, -1);
    const std::vector<Ray> rays = {make_ray({NAN, 0, 3}, d),       make_ray(o, {0, NAN, -1}), make_ray(o, {0, 0, 0}),
                                   make_ray(o, {0, 0, -INFINITY}), make_ray(o, d, NAN, 9),    make_ray(o, d, 5, 4)};
    for (const InstanceHit& hit : closest_hit(bvh, rays)) EXPECT_EQ(hit.primitive, CLARAY_MISS);
    // A direction that overflows in the object, or underflows to nothing, hits nothing either.
    const std::vector<Instance> extreme = {make_instance(glm::scale(glm::mat4(1.f), glm::vec3(1e-15f))),
                                           make_instance(glm::scale(glm::mat4(1.f), glm::vec3(1e15f)))};
    const InstancedBvh scaled = build(std::vector{sphere(1)}, extreme);
    for (const float length : {1e30f, 1e-38f})
        for (const InstanceHit& hit : closest_hit(scaled, std::vector{make_ray(o, length * d, 0.f, 1e-30f)}))
            EXPECT_EQ(hit.primitive, CLARAY_MISS);
}

INSTANTIATE_TEST_SUITE_P(Layouts, HardInstances, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

}  // namespace
}  // namespace claray::test
