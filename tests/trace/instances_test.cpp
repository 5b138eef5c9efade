// Queries of instances: trace/instances.cl, trace/traverse_instances.clh.
#include "claray/instances.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numeric>

#include "tests/oracle/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

class InstancesTest : public testing::TestWithParam<Layout> {
protected:
    static std::vector<Bvh> bottoms(std::span<const Mesh> meshes) { return build_bottoms(meshes, GetParam()); }
    static InstancedBvh build(std::span<const Mesh> meshes, std::span<const Instance> instances) {
        return InstancedBvh::build(bottoms(meshes), instances);
    }
};

void expect_hits_of_instances(const InstancedBvh& bvh, std::span<const Mesh> meshes,
                              std::span<const Instance> instances, const std::vector<Ray>& rays) {
    const InstanceComparison c = InstanceOracle(meshes, instances).compare(rays, closest_hit(bvh, rays));
    EXPECT_GT(c.hits, rays.size() / 200);
    EXPECT_EQ(c.wrong, 0u) << "of " << rays.size() << " rays, the first of them ray " << c.first_wrong;
    EXPECT_LT(c.marginal, rays.size() / 1000 + 3);
}

void expect_same(const std::vector<InstanceHit>& a, const std::vector<InstanceHit>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(same(a[i], b[i])) << i;
}

TEST_P(InstancesTest, IdentityGivesTheHitsOfTheStructureBitForBit) {
    const std::vector<Mesh> meshes = {soup(2003, 0.1f, 1)};
    const std::vector<Bvh> bottom = bottoms(meshes);
    const InstancedBvh bvh = InstancedBvh::build(bottom, std::vector{make_instance(glm::mat4(1.f))});
    for (const float radius : {3.f, 0.3f, 1000.f}) {
        const std::vector<Ray> rays = random_rays(10'007, radius, 1.f, 2);
        const std::vector<Hit> expected = closest_hit(bottom[0], rays);
        const std::vector<InstanceHit> hits = closest_hit(bvh, rays);
        std::size_t found = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const std::uint32_t instance = expected[i].primitive == CLARAY_MISS ? CLARAY_MISS : 0;
            const Hit& e = expected[i];
            ASSERT_TRUE(same(hits[i], {e.t, e.u, e.v, e.primitive, e.geometry, instance})) << i;
            found += instance == 0;
        }
        EXPECT_GT(found, 1000u);
        EXPECT_EQ(any_hit(bvh, rays), any_hit(bottom[0], rays));
    }
}

TEST_P(InstancesTest, HitsEqualTheOracle) {
    const std::vector<Mesh> meshes = {soup(60, 0.5f, 3), sphere(1), soup(1, 1.f, 4)};
    for (const std::size_t count : {1u, 2u, 3u, 7u, 203u}) {
        const std::vector<Instance> instances = random_instances(count, 3, 2.f, count < 10 ? 1.f : 0.3f, count);
        const InstancedBvh bvh = build(meshes, instances);
        expect_hits_of_instances(bvh, meshes, instances, random_rays(5003, 8.f, 2.f, 5));
        expect_hits_of_instances(bvh, meshes, instances, random_rays(5003, 0.5f, 2.f, 6));
    }
}

TEST_P(InstancesTest, OneBottomLevelIsAsSeveral) {
    const std::vector<Mesh> one = {sphere(2)}, two = {soup(5, 0.1f, 7), sphere(2)};
    std::vector<Instance> instances = random_instances(101, 1, 2.f, 0.3f, 8);
    const std::vector<Ray> rays = random_rays(5003, 6.f, 2.f, 9);
    const std::vector<InstanceHit> expected = closest_hit(build(one, instances), rays);
    for (Instance& instance : instances) instance.bottom = 1;
    expect_same(closest_hit(build(two, instances), rays), expected);
}

TEST_P(InstancesTest, HitsDoNotDependOnTheTopLevel) {
    const std::vector<Mesh> meshes = {soup(50, 0.5f, 10), sphere(1)};
    const std::vector<Instance> instances = random_instances(301, 2, 2.f, 0.3f, 11);
    const std::vector<Ray> rays = random_rays(5003, 5.f, 2.f, 12);
    const std::vector<InstanceHit> expected = closest_hit(build(meshes, instances), rays, brute_force);
    expect_same(closest_hit(build(meshes, instances), rays), expected);
    for (const auto& [builder, bits] : {std::pair(Builder::fast, 30u), std::pair(Builder::balanced, 63u)})
        expect_same(
            closest_hit(InstancedBvh::build(bottoms(meshes), instances, {.builder = builder, .morton_bits = bits}),
                        rays),
            expected);
    const Layout other = GetParam() == Layout::wide ? Layout::binary : Layout::wide;
    expect_same(closest_hit(InstancedBvh::build(build_bottoms(meshes, other), instances), rays), expected);
}

TEST_P(InstancesTest, AnyHitAgreesWithClosestHit) {
    const std::vector<Mesh> meshes = {soup(50, 0.3f, 13)};
    const InstancedBvh bvh = build(meshes, random_instances(100, 1, 2.f, 0.3f, 14));
    std::vector<Ray> rays = random_rays(10'007, 5.f, 2.f, 15);
    Random random(16);
    for (Ray& ray : rays) ray.tmin = random.uniform(0.f, 5.f), ray.tmax = ray.tmin + random.uniform(0.f, 3.f);
    const std::vector<InstanceHit> hits = closest_hit(bvh, rays);
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(occluded[i] != 0, hits[i].primitive != CLARAY_MISS) << i;
        ASSERT_TRUE(hits[i].t <= rays[i].tmax && (!occluded[i] || hits[i].t > rays[i].tmin)) << i;
    }
    EXPECT_GT(std::accumulate(occluded.begin(), occluded.end(), 0), 100);
    EXPECT_EQ(any_hit(bvh, rays, brute_force), occluded);
}

TEST_P(InstancesTest, MovedInstancesAreHitWhereTheyAre) {
    const std::vector<Mesh> meshes = {soup(40, 0.5f, 17), sphere(1)};
    const std::vector<Instance> before = random_instances(150, 2, 2.f, 0.3f, 18),
                                after = random_instances(150, 2, 2.f, 0.3f, 19);
    const std::vector<Ray> rays = random_rays(5003, 6.f, 2.f, 20);
    const std::vector<InstanceHit> expected = closest_hit(build(meshes, after), rays);
    InstancedBvh bvh = build(meshes, before);
    EXPECT_FALSE(same(closest_hit(bvh, rays)[0], expected[0]) && same(closest_hit(bvh, rays)[1], expected[1]));
    Buffer<Instance> instances = bvh.instances();
    instances.write(after);
    bvh.rebuild();
    expect_same(closest_hit(bvh, rays), expected);
    EXPECT_EQ(bvh.top().hash(), build(meshes, after).top().hash());

    instances.write(before);
    bvh.rebuild();
    instances.write(after);
    bvh.refit();
    EXPECT_TRUE(bvh.validate().ok());
    expect_same(closest_hit(bvh, rays), expected);
}

TEST_P(InstancesTest, BottomLevelsChangeToo) {
    std::vector<Mesh> meshes = {soup(300, 0.2f, 21), sphere(1)};
    const std::vector<Instance> one = random_instances(50, 1, 2.f, 0.3f, 22),
                                two = random_instances(50, 2, 2.f, 0.3f, 22);
    const std::vector<Ray> rays = random_rays(5003, 6.f, 2.f, 23);
    std::vector<Bvh> bottom = bottoms(meshes);
    InstancedBvh shared = InstancedBvh::build(std::span(bottom).first(1), one),
                 copied = InstancedBvh::build(bottom, two);
    for (glm::vec3& p : meshes[0].positions) p = 2.f * glm::vec3(p.y, p.x, p.z) + glm::vec3(0, 1, 0);
    std::vector<float> moved;
    for (const glm::vec3& p : meshes[0].positions) moved.insert(moved.end(), {p.x, p.y, p.z});
    Buffer<float> positions = bottom[0].triangles().positions;
    positions.write(moved);
    bottom[0].refit();
    shared.rebuild();
    expect_same(closest_hit(shared, rays), closest_hit(build(std::span(meshes).first(1), one), rays));
    copied.replace_bottoms(bottom);
    copied.rebuild();
    expect_same(closest_hit(copied, rays), closest_hit(build(meshes, two), rays));
    copied.replace_bottoms(std::span(bottom).first(1));  // the instances of the second lose what they stand for
    copied.rebuild();
    EXPECT_EQ(copied.statistics().culled,
              std::size_t(std::count_if(two.begin(), two.end(), [](const Instance& i) { return i.bottom == 1; })));
}

TEST_P(InstancesTest, MasksOfInstancesAndOfMeshesCount) {
    std::vector<Mesh> meshes = {grid(2), grid(2)};
    meshes[1].mask = 8;
    std::vector<Instance> instances;
    for (const float z : {0.f, -1.f, -2.f})
        instances.push_back(make_instance(glm::translate(glm::mat4(1.f), glm::vec3(0, 0, z))));
    instances[0].mask = 1, instances[1].mask = 2, instances[2].bottom = 1;
    const InstancedBvh bvh = build(meshes, instances);
    const std::vector<Ray> rays(6, make_ray({0.4f, 0.45f, 1.f}, {0, 0, -1}));
    QueryOptions with_masks;
    with_masks.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>{1, 2, 3, 8, 12, 4});
    const std::uint32_t expected[] = {0, 1, 0, 2, 2, CLARAY_MISS};
    const std::vector<InstanceHit> hits = closest_hit(bvh, rays, with_masks);
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays, with_masks);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(hits[i].instance, expected[i]) << i;
        EXPECT_EQ(occluded[i] != 0, expected[i] != CLARAY_MISS) << i;
    }
}

TEST_P(InstancesTest, FrontFacesAreTheObjects) {
    const std::vector<Mesh> meshes = {sphere(2)};
    std::vector<Instance> instances = random_instances(1, 1, 0.f, 1.f, 24);  // mirrored
    QueryOptions cull;
    cull.cull_back_faces = true;
    const std::vector<Ray> outside = random_rays(2000, 4.f, 0.2f, 25), inside = random_rays(2000, 0.1f, 5.f, 26);
    for (int mirrored = 1; mirrored >= 0; --mirrored) {
        const InstancedBvh bvh = build(meshes, instances);
        expect_same(closest_hit(bvh, outside, cull), closest_hit(bvh, outside));
        for (const InstanceHit& hit : closest_hit(bvh, inside, cull)) ASSERT_EQ(hit.primitive, CLARAY_MISS);
        for (const InstanceHit& hit : closest_hit(bvh, inside)) ASSERT_EQ(hit.instance, 0u);
        for (float* row : {instances[0].row0, instances[0].row1, instances[0].row2}) row[0] = -row[0];
    }
}

TEST_P(InstancesTest, CountsVisitsAndObeysTheCount) {
    const std::vector<Mesh> meshes = {sphere(1)};
    const InstancedBvh bvh = build(meshes, random_instances(50, 1, 1.f, 0.3f, 27));
    const Buffer<Ray> rays(device(), random_rays(100, 4.f, 1.f, 28));
    Buffer<InstanceHit> hits(device(), 100);
    Buffer<Visits> visits(device(), 100);
    hits.fill(0x12345678u), visits.fill(0);
    QueryOptions counting;
    counting.visits = visits;
    const Buffer<std::uint32_t> count(device(), std::vector<std::uint32_t>{37});
    closest_hit(bvh, rays, hits, counting, count);
    const std::vector<InstanceHit> found = hits.read(), all = closest_hit(bvh, rays.read());
    const std::vector<Visits> visited = visits.read();
    for (std::size_t i = 0; i < 100; ++i) {
        EXPECT_TRUE(i < 37 ? same(found[i], all[i]) : found[i].instance == 0x12345678u) << i;
        EXPECT_EQ(visited[i].nodes >= 1, i < 37) << i;
    }
    Buffer<std::uint8_t> occluded(device(), 100);
    occluded.write(std::vector<std::uint8_t>(100, 7));
    any_hit(bvh, rays, occluded, {}, count);
    EXPECT_EQ(occluded.read()[36], std::uint8_t(all[36].primitive != CLARAY_MISS));
    EXPECT_EQ(occluded.read()[37], 7);
}

TEST_P(InstancesTest, OwnKernelsTraceToo) {
    const std::vector<Mesh> meshes = {soup(50, 0.5f, 29), sphere(1)};
    const InstancedBvh bvh = build(meshes, random_instances(99, 2, 2.f, 0.3f, 30));
    const std::vector<Ray> rays = random_rays(999, 6.f, 2.f, 31);
    const Buffer<Ray> device_rays(device(), rays);
    Buffer<std::uint32_t> ids(device(), rays.size()), occluded(device(), rays.size());
    const char* source =
        "#include \"trace/traverse_instances.clh\"\n"
        "kernel void mine(CLARAY_INSTANCES_PARAMETERS, global const Ray* rays, global uint* ids, global uint* any) {\n"
        "    const uint i = get_global_id(0);\n"
        "    const InstanceHit hit = claray_closest_instance(CLARAY_INSTANCES, rays[i]);\n"
        "    ids[i] = hit.primitive == CLARAY_MISS ? 0 : claray_placed[hit.instance].id;\n"
        "    any[i] = claray_any_instance(CLARAY_INSTANCES, rays[i]);\n"
        "}\n";
    compile_kernel(device(), source, "mine", bvh.defines()).run({rays.size()}, bvh, device_rays, ids, occluded);
    const std::vector<InstanceHit> hits = closest_hit(bvh, rays);
    const std::vector<std::uint32_t> id = ids.read(), any = occluded.read();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool hit = hits[i].primitive != CLARAY_MISS;
        ASSERT_EQ(id[i], hit ? 1000 + hits[i].instance : 0) << i;
        ASSERT_EQ(any[i] != 0, hit) << i;
    }
}

TEST_P(InstancesTest, RefusesBuffersThatAreTooSmall) {
    const InstancedBvh bvh = build(std::vector{sphere(1)}, std::vector{make_instance(glm::mat4(1.f))});
    const Buffer<Ray> rays(device(), 10);
    Buffer<InstanceHit> few(device(), 9);
    Buffer<std::uint8_t> few_bytes(device(), 9);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "10 rays", [&] { closest_hit(bvh, rays, few); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "10 rays", [&] { any_hit(bvh, rays, few_bytes); }));
    EXPECT_TRUE(closest_hit(bvh, std::span<const Ray>()).empty());
}

INSTANTIATE_TEST_SUITE_P(Layouts, InstancesTest, testing::Values(Layout::binary, Layout::wide),
                         [](const auto& layout) { return layout.param == Layout::binary ? "Binary" : "Wide"; });

}  // namespace
}  // namespace claray::test
