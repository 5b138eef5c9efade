// The top level over instances: bvh/instances.cl.
#include "claray/instances.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "host/bvh/bvh_state.hpp"
#include "tests/oracle/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/not_finite.hpp"

namespace claray::test {
namespace {

TEST(InstancedBvh, IsValidAtEverySize) {
    const std::vector<Mesh> meshes = {sphere(1), soup(10, 0.3f, 1)};
    const std::vector<Bvh> bottoms = build_bottoms(meshes, Layout::binary);
    for (const unsigned bits : {30u, 63u})
        for (const Builder builder : {Builder::fast, Builder::balanced})
            for (const std::size_t count : {0u, 1u, 2u, 3u, 31u, 64u, 257u, 5003u}) {
                SCOPED_TRACE(testing::Message() << count << " instances, " << bits << " bits");
                const InstancedBvh bvh = InstancedBvh::build(bottoms, random_instances(count, 2, 2.f, 0.1f, count),
                                                             {.builder = builder, .morton_bits = bits});
                EXPECT_TRUE(bvh.validate().ok());
                const InstanceStatistics statistics = bvh.statistics();
                EXPECT_EQ(statistics.instances, count);
                EXPECT_EQ(statistics.culled, 0u);
                EXPECT_GE(statistics.top_bytes, count * (2 * sizeof(Instance)));
                EXPECT_EQ(statistics.widening > 0, count > 0);
                EXPECT_LT(statistics.widening, 1e-3f);
            }
}

TEST(InstancedBvh, LeavesHoldTheTransformedObjects) {
    const std::vector<Mesh> meshes = {sphere(1), soup(10, 0.3f, 2), grid(1)};
    for (const float offset : {0.f, 1e3f, 1e7f}) {
        std::vector<Instance> instances = random_instances(500, 3, 5.f, 0.3f, 3);
        for (Instance& i : instances) i.row0[3] += offset, i.row1[3] -= offset;
        const InstancedBvh bvh = InstancedBvh::build(build_bottoms(meshes, Layout::binary), instances);
        for (const LeafTriangle& leaf : state_of(bvh.top()).leaves.read()) {
            const glm::dvec3 lo(leaf.v0x, leaf.v0y, leaf.v0z), hi(leaf.v1x, leaf.v1y, leaf.v1z);
            for (const glm::dvec3& p : world_corners(meshes, std::span(&instances[leaf.primitive], 1)))
                ASSERT_TRUE(glm::all(glm::lessThanEqual(lo, p)) && glm::all(glm::lessThanEqual(p, hi)));
            const double loose = 4 + 1e-6 * offset;  // the box of a rotated box, and no more
            ASSERT_LT(glm::length(hi - lo), loose);
        }
    }
}

TEST(InstancedBvh, CullsWhatHasNoInverse) {
    const std::vector<Mesh> meshes = {sphere(1), Mesh{}};
    const std::vector<Bvh> bottoms = build_bottoms(meshes, Layout::binary);
    const std::vector<Instance> good = random_instances(100, 1, 2.f, 0.2f, 4);
    std::vector<Instance> all = good;
    const auto add = [&](auto&& damage) {
        Instance instance = good[7];
        damage(instance);
        all.push_back(instance);
    };
    add([](Instance& i) { i = make_instance(glm::mat4(0.f)); });
    add([](Instance& i) { i.row1[0] = nan; });
    add([](Instance& i) { i.row2[3] = infinity; });
    add([](Instance& i) { i.row0[3] = 1e19f; });
    add([](Instance& i) { i.row0[0] = i.row0[1] = i.row0[2] = 0.f; });  // flat
    add([](Instance& i) { std::copy(i.row0, i.row0 + 4, i.row2); });    // flat, off the axes
    add([](Instance& i) { i.row0[0] = 3e38f; });
    add([](Instance& i) { i = make_instance(glm::scale(glm::mat4(1.f), glm::vec3(1e-30f))); });
    add([](Instance& i) { i.bottom = 1; });  // empty
    add([](Instance& i) { i.bottom = 2; });  // not there
    add([](Instance& i) { i.bottom = 0xffffffffu; });
    const InstancedBvh bvh = InstancedBvh::build(bottoms, all);
    EXPECT_TRUE(bvh.validate().ok());
    EXPECT_EQ(bvh.statistics().instances, 100u);
    EXPECT_EQ(bvh.statistics().culled, 11u);
    EXPECT_EQ(bvh.top().hash(), InstancedBvh::build(bottoms, good).top().hash());

    const InstancedBvh nothing = InstancedBvh::build(bottoms, std::vector<Instance>(3));
    EXPECT_EQ(nothing.statistics().culled, 3u);
    EXPECT_EQ(closest_hit(nothing, random_rays(1, 3.f, 1.f, 5))[0].primitive, CLARAY_MISS);
}

TEST(InstancedBvh, TakesTransformsThatAreHardToInvert) {
    const std::vector<Mesh> meshes = {sphere(1)};
    std::vector<Instance> instances;
    for (const float thin : {1e-3f, 1e-5f})  // a shadow on the floor of what was turned before
        instances.push_back(make_instance(glm::scale(glm::mat4(1.f), glm::vec3(1, thin, 1)) *
                                          glm::rotate(glm::mat4(1.f), 1.f, glm::normalize(glm::vec3(1, 2, 3)))));
    for (const float scale : {1e-12f, 1e12f})
        instances.push_back(make_instance(glm::scale(glm::mat4(1.f), glm::vec3(scale))));
    const InstancedBvh bvh = InstancedBvh::build(build_bottoms(meshes, Layout::binary), instances);
    EXPECT_EQ(bvh.statistics().culled, 0u);
    EXPECT_TRUE(bvh.validate().ok());
}

TEST(InstancedBvh, IsTheSameTreeEveryTime) {
    const std::vector<Mesh> meshes = {sphere(1)};
    InstancedBvh bvh =
        InstancedBvh::build(build_bottoms(meshes, Layout::binary), random_instances(5003, 1, 2.f, 0.05f, 6));
    const std::string hash = bvh.top().hash();
    for (int i = 0; i < 10; ++i) {
        bvh.rebuild();
        ASSERT_EQ(bvh.top().hash(), hash) << "rebuild " << i;
    }
    bvh.refit();
    EXPECT_EQ(bvh.top().hash(), hash);
}

TEST(InstancedBvh, RefusesBottomLevelsThatDoNotFitTogether) {
    const std::vector<Mesh> meshes = {sphere(1)};
    std::vector<Bvh> bottoms = build_bottoms(meshes, Layout::binary);
    const std::vector<Instance> one = {make_instance(glm::mat4(1.f))};
    EXPECT_TRUE(throws_error(ErrorKind::usage, "without a bottom level", [&] { (void)InstancedBvh::build({}, one); }));
    InstancedBvh bvh = InstancedBvh::build(bottoms, one);
    bottoms.push_back(build_bottoms(meshes, Layout::wide)[0]);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "different layouts", [&] { (void)InstancedBvh::build(bottoms, one); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "different layouts", [&] { bvh.replace_bottoms(bottoms); }));
    bottoms[1] = Bvh::build(Device::open(std::to_string(device().info().index)), meshes, {.layout = Layout::binary});
    EXPECT_TRUE(throws_error(ErrorKind::usage, "different devices", [&] { (void)InstancedBvh::build(bottoms, one); }));
    EXPECT_TRUE(bvh.validate().ok());
}

}  // namespace
}  // namespace claray::test
