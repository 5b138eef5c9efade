// Instances that move, hit by rays of all times: bvh/instances/moving_instance.clh and the boxes of bvh/instances.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/oracle/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

class MovingInstances : public testing::TestWithParam<Layout> {
protected:
    static InstancedBvh build(std::span<const Mesh> meshes, std::span<const Instance> begins,
                              std::span<const Instance> ends) {
        return InstancedBvh::build(build_bottoms(meshes, GetParam()), begins, ends, {});
    }
};

std::vector<InstanceHit> hits_at(const InstancedBvh& bvh, const std::vector<Ray>& rays, const std::vector<float>& times,
                                 bool without_tree = false) {
    QueryOptions options;
    options.ray_times = Buffer<float>(device(), times);
    options.brute_force = without_tree;
    return closest_hit(bvh, rays, options);
}

TEST_P(MovingInstances, HitsEqualTheOracleAtEveryTime) {
    const std::vector<Mesh> meshes = {soup(60, 0.5f, 3), sphere(1)};
    for (const std::size_t count : {1u, 2u, 3u, 101u}) {
        const std::vector<Instance> begins = random_instances(count, 2, 2.f, count < 10 ? 1.f : 0.3f, count);
        const std::vector<Instance> ends = moved(begins, 1.5f, count + 1);
        const InstancedBvh bvh = build(meshes, begins, ends);
        EXPECT_TRUE(bvh.validate().ok());
        EXPECT_EQ(bvh.statistics().culled, 0u);
        EXPECT_LT(bvh.statistics().widening, 1e-3f);
        for (const float time : {0.f, 0.3f, 0.7182818f, 1.f}) {
            SCOPED_TRACE(testing::Message() << count << " instances at time " << time);
            const std::vector<Ray> rays = random_rays(3001, 8.f, 2.f, 5);
            const InstanceComparison c = InstanceOracle(meshes, begins, ends, time)
                                             .compare(rays, hits_at(bvh, rays, std::vector<float>(3001, time)));
            EXPECT_GT(c.hits, rays.size() / 200);
            EXPECT_EQ(c.wrong, 0u) << "of " << rays.size() << " rays, the first of them ray " << c.first_wrong;
            EXPECT_LT(c.marginal, rays.size() / 1000 + 3);
        }
    }
}

/// As precise a thousand kilometres from the origin, seen from nearby, however far they move.
TEST_P(MovingInstances, HitsEqualTheOracleFarFromTheOrigin) {
    const std::vector<Mesh> meshes = {soup(60, 0.5f, 3)};
    std::vector<Instance> begins = random_instances(30, 1, 80.f, 20.f, 6);
    for (Instance& i : begins) i.row0[3] += 1e6f, i.row1[3] += 1e6f, i.row2[3] += 1e6f;
    const std::vector<Instance> ends = moved(begins, 50.f, 7);
    std::vector<Ray> rays = random_rays(3001, 240.f, 80.f, 8);
    for (Ray& r : rays) r.ox += 1e6f, r.oy += 1e6f, r.oz += 1e6f;
    const InstanceComparison c =
        InstanceOracle(meshes, begins, ends, 0.375)
            .compare(rays, hits_at(build(meshes, begins, ends), rays, std::vector<float>(3001, 0.375f)));
    EXPECT_GT(c.hits, 500u);
    EXPECT_EQ(c.wrong, 0u);
    EXPECT_LT(c.marginal, c.rays / 500);
}

TEST_P(MovingInstances, TheTopLevelLosesNothing) {
    const std::vector<Mesh> meshes = {grid(2), sphere(1)};
    for (const float scale : {1.f, 1e-3f}) {
        std::vector<Instance> begins = random_instances(200, 2, 3.f, 0.4f * scale, 9);
        for (std::size_t i = 0; i < begins.size(); i += 4) begins[i] = make_instance(glm::mat4(1.f));  // flat boxes
        const InstancedBvh bvh = build(meshes, begins, moved(begins, 2.f, 10));
        std::vector<Ray> rays = random_rays(20'000, 6.f, 3.f, 11);
        std::vector<float> times;
        Random random(12);
        for (std::size_t i = 0; i < rays.size(); ++i) times.push_back(i % 3 ? random.uniform() : float(i % 2));
        const std::vector<InstanceHit> fast = hits_at(bvh, rays, times), slow = hits_at(bvh, rays, times, true);
        std::size_t hits = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_TRUE(same(fast[i], slow[i])) << i << " at time " << times[i];
            hits += slow[i].primitive != CLARAY_MISS;
        }
        EXPECT_GT(hits, 100u);
        QueryOptions options;
        options.ray_times = Buffer<float>(device(), times);
        const std::vector<std::uint8_t> occluded = any_hit(bvh, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(occluded[i] != 0, fast[i].primitive != CLARAY_MISS) << i;
    }
}

TEST_P(MovingInstances, ThoseThatStandStillAreHitAsEver) {
    const std::vector<Mesh> meshes = {soup(50, 0.5f, 13), sphere(1)};
    const std::vector<Instance> instances = random_instances(101, 2, 2.f, 0.3f, 14);
    const std::vector<Ray> rays = random_rays(5003, 6.f, 2.f, 15);
    const InstancedBvh still = InstancedBvh::build(build_bottoms(meshes, GetParam()), instances),
                       moving = build(meshes, instances, instances);
    EXPECT_EQ(moving.top().hash(), still.top().hash());
    EXPECT_EQ(moving.statistics().widening, still.statistics().widening);
    const std::vector<InstanceHit> expected = closest_hit(still, rays);
    const std::vector<InstanceHit> at_once = closest_hit(moving, rays),
                                   later = hits_at(moving, rays, std::vector<float>(rays.size(), 0.6f));
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(same(at_once[i], expected[i])) << i;
        ASSERT_TRUE(same(later[i], expected[i])) << i;
    }
}

TEST_P(MovingInstances, RebuildAndRefitFollowBothEnds) {
    const std::vector<Mesh> meshes = {sphere(1)};
    const std::vector<Instance> begins = random_instances(150, 1, 2.f, 0.3f, 16), ends = moved(begins, 1.f, 17);
    const std::vector<Instance> later = moved(begins, 2.f, 18);
    const std::vector<Ray> rays = random_rays(5003, 6.f, 2.f, 19);
    const std::vector<float> times(rays.size(), 0.8f);
    const std::vector<InstanceHit> expected = hits_at(build(meshes, ends, later), rays, times);
    InstancedBvh bvh = build(meshes, begins, ends);
    for (const bool refit : {false, true}) {
        Buffer<Instance> from = bvh.instances(), to = bvh.ends();
        from.write(begins), to.write(ends);
        bvh.rebuild();
        EXPECT_FALSE(same(hits_at(bvh, rays, times)[1], expected[1]) &&
                     same(hits_at(bvh, rays, times)[2], expected[2]));
        from.write(ends), to.write(later);
        refit ? bvh.refit() : bvh.rebuild();
        EXPECT_TRUE(bvh.validate().ok());
        const std::vector<InstanceHit> hits = hits_at(bvh, rays, times);
        for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(hits[i], expected[i])) << i;
    }
}

/// The matrix of half a turn passes through one that has no inverse.
TEST_P(MovingInstances, WhatLosesItsInverseIsLeftOut) {
    const std::vector<Mesh> meshes = {sphere(1)};
    const auto turned = [](float degrees) {
        return make_instance(glm::rotate(glm::mat4(1.f), glm::radians(degrees), glm::normalize(glm::vec3(1, 2, 3))));
    };
    const Instance still = turned(0);
    const auto culled = [&](const Instance& end) {
        return build(meshes, std::vector{still}, std::vector{end}).statistics().culled;
    };
    EXPECT_EQ(culled(turned(90)), 0u);
    EXPECT_EQ(culled(turned(175)), 0u);
    EXPECT_EQ(culled(turned(180)), 1u);
    EXPECT_EQ(culled(make_instance(glm::scale(glm::mat4(1.f), glm::vec3(-1, 1, 1)))), 1u);
    EXPECT_EQ(culled(make_instance(glm::scale(glm::mat4(1.f), glm::vec3(-0.37f, 1, 1)))), 1u);
    EXPECT_EQ(culled(make_instance(glm::mat4(0.f))), 1u);
    Instance broken = still;
    broken.row1[3] = NAN;
    EXPECT_EQ(culled(broken), 1u);
}

TEST_P(MovingInstances, RefusesEndsThatAreTooFew) {
    const std::vector<Instance> two(2, make_instance(glm::mat4(1.f))), one(1, two[0]);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "1 ends", [&] { (void)build(std::vector{sphere(1)}, two, one); }));
    QueryOptions options;
    options.ray_times = Buffer<float>(device(), 3);
    const InstancedBvh bvh = build(std::vector{sphere(1)}, one, one);
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "ray times", [&] { (void)closest_hit(bvh, std::vector<Ray>(4), options); }));
}

TEST_P(MovingInstances, OwnKernelsTraceAtTimes) {
    const std::vector<Mesh> meshes = {sphere(1)};
    const std::vector<Instance> begins = random_instances(20, 1, 2.f, 0.5f, 20), ends = moved(begins, 1.f, 21);
    const InstancedBvh bvh = build(meshes, begins, ends);
    const std::vector<Ray> rays = random_rays(500, 6.f, 2.f, 22);
    const std::vector<float> times(rays.size(), 0.4f);
    Buffer<InstanceHit> hits(device(), rays.size());
    Buffer<std::uint32_t> any(device(), rays.size());
    compile_kernel(device(), R"(
        #include "trace/traverse_instances.clh"
        kernel void mine(CLARAY_INSTANCES_PARAMETERS, global const Ray* rays, global InstanceHit* hits, global uint* any) {
            const uint i = get_global_id(0);
            hits[i] = claray_closest_instance_at(CLARAY_INSTANCES, rays[i], 0.4f);
            any[i] = claray_any_instance_at(CLARAY_INSTANCES, rays[i], 0.4f);
        })",
                   "mine", bvh.defines())
        .run({rays.size()}, bvh, Buffer<Ray>(device(), rays), hits, any);
    const std::vector<InstanceHit> expected = hits_at(bvh, rays, times), found = hits.read();
    const std::vector<std::uint32_t> occluded = any.read();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(same(found[i], expected[i])) << i;
        ASSERT_EQ(occluded[i] != 0, expected[i].primitive != CLARAY_MISS) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Layouts, MovingInstances, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

}  // namespace
}  // namespace claray::test
