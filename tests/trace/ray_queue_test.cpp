// Rays from a queue, trace/queue/ray_queue.clh, and what chooses its schedule, trace/queue/sample_coherence.cl. On
// devices without warps the rays are dealt out in strides to fewer items than there are rays.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

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

std::uint32_t coherent(const std::vector<Ray>& rays) {
    Buffer<std::uint32_t> queue(device(), 3);
    queue.fill(7);
    load_kernel(device(), "trace/queue/sample_coherence.cl", "sample_coherence", {{"GROUP_SIZE", "256"}})
        .run({256, 256}, Buffer<Ray>(device(), rays), std::uint32_t(rays.size()), arg("count", nullptr),
             arg("queue", queue));
    const std::vector<std::uint32_t> words = queue.read();
    EXPECT_EQ(words[0], 7u);
    EXPECT_EQ(words[1], 7u);
    return words[2];
}

TEST(RayQueue, TellsCoherentRaysFromOthers) {
    for (const std::size_t count : {20u, 1000u, 100'000u}) {
        EXPECT_EQ(coherent(rays_from_centre(count, true)), 1u) << count;
        EXPECT_EQ(coherent(rays_from_centre(count, false)), 0u) << count;
    }
    EXPECT_EQ(coherent({}), 0u);
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
