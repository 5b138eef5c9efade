// Rays from a queue, trace/queue/ray_queue.clh, and what chooses its schedule. On devices without warps the rays are
// dealt out in strides to fewer items than there are rays.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

/// Rays from a point: side by side, or each in another direction.
std::vector<Ray> rays_from_centre(std::size_t count, bool side_by_side) {
    std::vector<Ray> rays(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float angle = side_by_side ? 0.3f * float(i) / float(count) : 2.4f * float(i);  // the golden angle
        const float height = side_by_side ? 0.1f : 1.f - 2.f * (float(i) + 0.5f) / float(count);
        rays[i] = {0.01f, 0.02f, 0.03f, 0.f, std::cos(angle), height, std::sin(angle), 1e30f};
    }
    return rays;
}

/// What a kernel without a hint decides; devices without warps have one schedule.
std::optional<bool> coherent(const std::vector<Ray>& rays) {
    const char* source = R"(
        #include "trace/queue/ray_queue.clh"
        kernel void decide(global const Ray* rays, uint count, global uint* decision) {
        #if USE_RAY_QUEUE
            const Query query = {rays, 0, count, false, 0, NO_ANSWERS};
            const uint coherent = rays_are_coherent(&query);
        #else
            const uint coherent = 2;
        #endif
            if (get_global_id(0) == 0) *decision = coherent;
        })";
    Buffer<std::uint32_t> decision(device(), 1);
    compile_kernel(device(), source, "decide", {{"RAY_QUEUE", "1"}})
        .run({32, 32}, Buffer<Ray>(device(), rays), std::uint32_t(rays.size()), decision);
    const std::uint32_t found = decision.read()[0];
    return found == 2 ? std::nullopt : std::optional<bool>(found != 0);
}

TEST(RayQueue, TellsCoherentRaysFromOthers) {
    for (const std::size_t count : {20u, 1000u, 100'000u}) {
        const std::optional<bool> side_by_side = coherent(rays_from_centre(count, true));
        if (!side_by_side) GTEST_SKIP() << "no warps";
        EXPECT_TRUE(*side_by_side) << count;
        EXPECT_FALSE(*coherent(rays_from_centre(count, false))) << count;
    }
}

/// Rays at the ends of rows, whose neighbours point elsewhere, are few in pictures of any size.
TEST(RayQueue, TakesPicturesForCoherent) {
    for (const unsigned width : {256, 512, 1920})
        for (const unsigned height : {62, 256, 992}) {
            const std::optional<bool> found = coherent(camera_rays({0, 0, 3}, glm::vec3(0.f), width, height, 1.5f));
            if (!found) GTEST_SKIP() << "no warps";
            EXPECT_TRUE(*found) << width << " x " << height;
        }
}

TEST(RayQueue, FindsTheSameHitsInEverySchedule) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    for (const char* query : {"trace/closest_hit", "trace/any_hit"}) {
        fresh.set_tuning(query, "RAY_QUEUE", 1);
        fresh.set_tuning(query, "GROUPS_PER_UNIT", 1);
        fresh.set_tuning(query, "GROUP_SIZE", 64);
        fresh.set_tuning(query, "RAYS_PER_ITEM", 1);
    }
    const Mesh mesh = sphere(3);
    const Bvh queued = Bvh::build(fresh, std::span(&mesh, 1), {.layout = Layout::binary});
    const Bvh plain = Bvh::build(device(), std::span(&mesh, 1), {.layout = Layout::binary});
    for (const bool side_by_side : {true, false})
        for (const std::size_t count : {1u, 31u, 64u, 5000u}) {
            const std::vector<Ray> rays = rays_from_centre(count, side_by_side);
            const std::vector<Hit> expected = closest_hit(plain, rays, brute_force);
            for (const Coherence coherence : {Coherence::automatic, Coherence::coherent, Coherence::incoherent}) {
                QueryOptions options;
                options.coherence = coherence;
                for (int again = 0; again < 2; ++again) {  // the queue is left as it was
                    const std::vector<Hit> hits = closest_hit(queued, rays, options);
                    ASSERT_EQ(std::memcmp(hits.data(), expected.data(), count * sizeof(Hit)), 0) << count;
                    for (const std::uint8_t occluded : any_hit(queued, rays, options)) ASSERT_EQ(occluded, 1);
                }
            }
        }
}

}  // namespace
}  // namespace claray::test
