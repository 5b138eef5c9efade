// Instances whose levels the host builds, for a first picture: build_by_host and
// trace/traverse_small.clh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/host_tree.hpp"
#include "host/bvh/instances_state.hpp"
#include "tests/oracle/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

class HostInstances : public testing::Test {
protected:
    void SetUp() override {
        if (!device().info().fp64) GTEST_SKIP() << "the device has no float64";
    }
};

std::vector<Bvh> bottoms_by_host(std::span<const Mesh> meshes) {
    std::vector<Bvh> bottoms;
    for (const Mesh& mesh : meshes) bottoms.push_back(build_by_host(device(), std::span(&mesh, 1), {}));
    return bottoms;
}

InstancedBvh by_host(std::span<const Mesh> meshes, std::span<const Instance> begins, std::span<const Instance> ends) {
    return build_by_host(bottoms_by_host(meshes), begins, ends, {});
}

InstancedBvh by_device(std::span<const Mesh> meshes, std::span<const Instance> begins, std::span<const Instance> ends) {
    const std::vector<Bvh> bottoms = build_bottoms(meshes, Layout::automatic);
    return ends.empty() ? InstancedBvh::build(bottoms, begins) : InstancedBvh::build(bottoms, begins, ends, {});
}

/// Boxes of the top level's leaves in the order of the instances.
std::vector<LeafTriangle> boxes(const InstancedBvh& bvh) {
    std::vector<LeafTriangle> leaves(state_of(bvh.top()).read_header().valid);
    state_of(bvh.top()).leaves.read(std::span(leaves));
    std::sort(leaves.begin(), leaves.end(), [](auto& a, auto& b) { return a.primitive < b.primitive; });
    return leaves;
}

template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(std::memcmp(&a[i], &b[i], sizeof(T)), 0) << i;
}

void expect_same_placement(const InstancedBvh& host, const InstancedBvh& other) {
    EXPECT_TRUE(host.validate().ok());
    EXPECT_EQ(host.statistics().culled, other.statistics().culled);
    EXPECT_EQ(host.statistics().widening, other.statistics().widening);
    expect_same_bits(state_of(host).placed.read(), state_of(other).placed.read());
    expect_same_bits(boxes(host), boxes(other));
}

/// The host compiles the kernels' text: not a bit may differ, or rays in objects would.
TEST_F(HostInstances, ArePlacedAsByTheDevice) {
    const std::vector<Mesh> meshes = {sphere(1), soup(10, 0.3f, 2), Mesh{}};
    std::vector<Instance> begins = random_instances(2003, 2, 5.f, 0.3f, 3);
    for (std::size_t i = 0; i < begins.size(); i += 7) begins[i].row0[3] += 1e6f, begins[i].row2[1] *= 1e-3f;
    begins[1] = make_instance(glm::mat4(0.f));
    begins[2].row1[0] = std::numeric_limits<float>::quiet_NaN();
    begins[3].row2[3] = std::numeric_limits<float>::infinity();
    begins[4].bottom = 2;                                           // empty
    begins[5].bottom = 3;                                           // not there
    std::copy(begins[6].row0, begins[6].row0 + 4, begins[6].row2);  // flat
    expect_same_placement(by_host(meshes, begins, {}), by_device(meshes, begins, {}));
    std::vector<Instance> ends = moved(begins, 1.5f, 4);
    ends[8] = begins[8];
    ends[9] = make_instance(glm::mat4(-1.f), begins[9].bottom);  // loses its inverse on the way, perhaps
    expect_same_placement(by_host(meshes, begins, ends), by_device(meshes, begins, ends));
}

TEST_F(HostInstances, GiveTheSameHits) {
    const std::vector<Mesh> meshes = {soup(60, 0.5f, 3), sphere(2)};
    for (const std::size_t count : {0u, 1u, 2u, 301u}) {
        const std::vector<Instance> begins = random_instances(count, 2, 2.f, 0.3f, count), ends = moved(begins, 1.f, 5);
        const std::vector<Ray> rays = random_rays(5003, 5.f, 2.f, 6);
        std::vector<float> times;
        for (std::size_t i = 0; i < rays.size(); ++i) times.push_back(float(i % 17) / 16.f);
        for (const bool moves : {false, true}) {
            SCOPED_TRACE(testing::Message() << count << " instances, moving " << moves);
            QueryOptions options;
            if (moves) options.ray_times = Buffer<float>(device(), times);
            const std::vector<Instance> to = moves ? ends : std::vector<Instance>();
            const InstancedBvh host = by_host(meshes, begins, to), other = by_device(meshes, begins, to);
            const std::vector<InstanceHit> here = closest_hit(host, rays, options);
            const std::vector<InstanceHit> there = closest_hit(other, rays, options);
            for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(here[i], there[i])) << i;
            EXPECT_EQ(any_hit(host, rays, options), any_hit(other, rays, options));
        }
        const InstanceComparison c =
            InstanceOracle(meshes, begins).compare(rays, closest_hit(by_host(meshes, begins, {}), rays));
        EXPECT_EQ(c.wrong, 0u);
        EXPECT_GE(c.hits, count > 2 ? rays.size() / 200 + 1 : 0);
    }
}

TEST_F(HostInstances, CanBeRefittedAndRebuilt) {
    const std::vector<Mesh> meshes = {sphere(1)};
    const std::vector<Instance> begins = random_instances(101, 1, 2.f, 0.3f, 7), later = moved(begins, 1.f, 8);
    const std::vector<Ray> rays = random_rays(3001, 5.f, 2.f, 9);
    const std::vector<InstanceHit> expected = closest_hit(by_device(meshes, later, {}), rays);
    for (const bool anew : {false, true}) {
        InstancedBvh bvh = by_host(meshes, begins, {});
        Buffer<Instance>(bvh.instances()).write(later);
        anew ? bvh.rebuild() : bvh.refit();
        EXPECT_TRUE(bvh.validate().ok());
        const std::vector<InstanceHit> hits = closest_hit(bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(same(hits[i], expected[i])) << i;
    }
}

/// Masks, sides, several sheets at one distance, and rays through edges: all that may decide a hit.
TEST(SmallTraversal, GivesTheSameHitsUnderAllOptions) {
    std::vector<Mesh> meshes = {soup(2003, 0.2f, 1), grid(8), grid(8), grid(5)};
    for (std::size_t i = 0; i < meshes.size(); ++i) meshes[i].mask = 1u << i | 8u;
    std::vector<Ray> rays = random_rays(5003, 2.f, 1.f, 2);
    const std::size_t random = rays.size();
    for (const float tmax : {1e9f, 1.f})  // the second just as far as the sheets
        for (const glm::vec3& p : meshes[1].positions) rays.push_back({p.x, p.y, p.z + 1.f, 0, 0, 0, -1, tmax});
    std::vector<std::uint32_t> masks;
    for (std::size_t i = 0; i < rays.size(); ++i) masks.push_back(i % 16);
    QueryOptions options;
    options.cull_back_faces = true;
    options.ray_masks = Buffer<std::uint32_t>(device(), masks);
    const Bvh host = build_by_host(device(), meshes, {}),
              other = Bvh::build(device(), meshes, {.layout = Layout::binary});
    const std::vector<Hit> here = closest_hit(host, rays, options), there = closest_hit(other, rays, options);
    std::size_t hits = 0, of_sheets = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(std::memcmp(&here[i], &there[i], sizeof(Hit)), 0) << i;
        (i < random ? hits : of_sheets) += here[i].primitive != CLARAY_MISS;
    }
    EXPECT_GT(hits, random / 10);
    EXPECT_GT(of_sheets, (rays.size() - random) / 4);
    EXPECT_EQ(any_hit(host, rays, options), any_hit(other, rays, options));
}

}  // namespace
}  // namespace claray::test
