// Every unit kernel at small sizes, to be run in Oclgrind: tests/oclgrind/run.cmake fails on any of its reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>

#include "claray/instances.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/sort/radix_sort.hpp"
#include "host/verify/run.hpp"

namespace claray::test {
namespace {

/// One device for all tests, since Oclgrind's compiler takes most of their time. It must be closed before the statics
/// of that compiler are destroyed.
class OneDevice : public testing::Environment {
public:
    void SetUp() override {
        device_ = Device::open();
        // Or most time would go into empty buckets and into places of a tile behind the last key.
        device_->set_tuning("sort/bucket_sort", "BUCKET_BITS", 5);
        device_->set_tuning("sort/radix_sort", "ITEMS", 1);  // of 300 keys the tiles are two
    }
    void TearDown() override { device_.reset(); }
    [[nodiscard]] const Device& device() const { return *device_; }

private:
    std::optional<Device> device_;
};

const OneDevice& one = static_cast<const OneDevice&>(*testing::AddGlobalTestEnvironment(new OneDevice));

/// `count` triangles in the unit cube; every tenth is junk that the build must leave out.
Mesh soup(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.f, 1.f), small(-0.1f, 0.1f);
    Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 corner(unit(random), unit(random), unit(random));
        for (int v = 0; v < 3; ++v)
            mesh.positions.push_back(corner + glm::vec3(small(random), small(random), small(random)));
        if (i % 10 == 9) mesh.positions.back().x = NAN;
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

std::vector<Ray> rays_through_the_cube(std::size_t count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0.f, 1.f);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i)
        rays.push_back({unit(random), unit(random), -1.f, 0.f, 0.f, 0.f, 1.f, 10.f});
    return rays;
}

template <class Key>
void sort_all(const Device& device, bool onesweep) {
    for (const std::size_t count : {1u, 2u, 255u, 300u}) {
        std::mt19937_64 random(count);
        std::vector<Key> keys(count);
        for (Key& key : keys) key = Key(random());
        Buffer<Key> device_keys(device, keys);
        Buffer<std::uint32_t> values(device, count);
        RadixSort<Key>(device, count, {.onesweep = onesweep}).sort(device_keys, values, count);
        std::sort(keys.begin(), keys.end());
        ASSERT_EQ(device_keys.read(), keys);
    }
}

TEST(UnitKernels, SortBothSchedules) {
    const Device& device = one.device();
    std::printf("on %s\n", device.info().name.c_str());
    for (const bool onesweep : {false, true}) {
        sort_all<std::uint32_t>(device, onesweep);
        sort_all<std::uint64_t>(device, onesweep);
    }
}

class UnitKernelsOnLayout : public testing::TestWithParam<Layout> {};

TEST_P(UnitKernelsOnLayout, BuildRefitAndTrace) {
    const Device& device = one.device();
    const std::vector<Ray> rays = rays_through_the_cube(65);
    for (const unsigned bits : {30u, 63u})
        for (const std::size_t count : {0u, 1u, 2u, 3u, 130u}) {
            if (bits == 63 && count < 130) continue;  // only the codes differ, and the sort takes most of the time
            const Mesh mesh = soup(count);
            Bvh bvh = Bvh::build(device, {&mesh, 1}, {.morton_bits = bits, .layout = GetParam()});
            EXPECT_EQ(state_of(bvh).read_header().culled, count / 10);
            bvh.refit();
            bvh.rebuild();
            EXPECT_TRUE(bvh.validate().ok()) << count << " triangles, " << bits << " bits";

            Buffer<Visits> visits(device, rays.size());
            QueryOptions counting, brute_force;
            counting.visits = visits;
            brute_force.brute_force = true;
            const auto hits = closest_hit(bvh, rays, counting);
            const auto expected = closest_hit(bvh, rays, brute_force);
            const auto occluded = any_hit(bvh, rays);
            for (std::size_t i = 0; i < rays.size(); ++i) {
                EXPECT_EQ(hits[i].primitive, expected[i].primitive);
                EXPECT_EQ(occluded[i] != 0, expected[i].primitive != CLARAY_MISS);
            }
        }
}

/// Both builders by both schedules: every leaf climbs by itself, or one work-item joins a range.
TEST(UnitKernels, BuildBySchedule) {
    const Device& device = one.device();
    for (const unsigned ranges : {0u, 5u}) {
        const claray::ScopedTuning schedule(device, "bvh/serial", "RANGES_PER_UNIT", ranges);
        const claray::ScopedTuning leaves(device, "bvh/serial", "RANGE_LEAVES", 1);
        for (const Builder builder : {Builder::fast, Builder::balanced, Builder::high})
            for (const std::size_t count : {2u, 40u}) {  // `high` divides more than 32 among groups
                const Mesh mesh = soup(count);
                const Bvh bvh = Bvh::build(device, {&mesh, 1}, {.builder = builder, .morton_bits = 30});
                EXPECT_EQ(bvh.statistics().triangles, count - count / 10);
                EXPECT_TRUE(bvh.validate().ok()) << count << " triangles, " << ranges << " ranges";
            }
    }
}

TEST_P(UnitKernelsOnLayout, PlaceAndTraceInstances) {
    const Device& device = one.device();
    const std::vector<Ray> rays = rays_through_the_cube(65);
    std::vector<Bvh> bottoms;
    for (const std::size_t count : {20u, 0u, 3u}) {
        const Mesh mesh = soup(count);
        bottoms.push_back(Bvh::build(device, {&mesh, 1}, {.morton_bits = 30, .layout = GetParam()}));
    }
    for (const std::size_t count : {0u, 1u, 2u, 67u}) {
        std::vector<Instance> instances;
        for (std::uint32_t i = 0; i < count; ++i) {  // of bottom levels that are empty and missing, too
            glm::mat4 m(1.f);
            m[3] = glm::vec4(0.1f * float(i % 7) - 0.3f, 0.05f * float(i % 5), 0.01f * float(i), 1.f);
            instances.push_back(make_instance(m, i % 4));
        }
        InstancedBvh bvh = InstancedBvh::build(bottoms, instances);
        bvh.refit();
        bvh.rebuild();
        EXPECT_TRUE(bvh.validate().ok()) << count << " instances";
        QueryOptions every;
        every.brute_force = true;
        const auto hits = closest_hit(bvh, rays), expected = closest_hit(bvh, rays, every);
        const auto occluded = any_hit(bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(hits[i].instance, expected[i].instance);
            EXPECT_EQ(occluded[i] != 0, expected[i].primitive != CLARAY_MISS);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Layouts, UnitKernelsOnLayout, testing::Values(Layout::binary, Layout::wide));

}  // namespace
}  // namespace claray::test
