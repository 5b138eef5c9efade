// How rays in any order are sorted on CPUs, trace/queue/ray_order.cl: the keys bit by bit, and whether it is done at
// all.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "claray/bvh.hpp"
#include "claray/profiler.hpp"
#include "claray/program.hpp"
#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

Bvh cube_of_triangles() {
    const Mesh mesh = soup(500, 0.1f, 3);
    return Bvh::build(device(), std::span(&mesh, 1));
}

/// A coordinate's cell of `cells`, or -1 if it is too close to a border for float32.
int cell_of(double at, int cells) {
    const double scaled = at * cells;
    if (std::abs(scaled - std::round(scaled)) < 1e-3) return -1;
    return std::clamp(int(std::floor(scaled)), 0, cells - 1);
}

/// The octahedral map of a direction, both coordinates from 0 to 1.
std::array<double, 2> octahedral(glm::dvec3 d) {
    d /= std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
    if (d.z < 0) d = {std::copysign(1 - std::abs(d.y), d.x), std::copysign(1 - std::abs(d.x), d.y), d.z};
    return {(d.x + 1) / 2, (d.y + 1) / 2};
}

/// Five bits an axis of where the ray begins, x before y before z, then eight bits an axis of where it runs; -1: can't
/// say.
std::int64_t expected_key(const Ray& ray, const BvhHeader& box) {
    const int start[3] = {cell_of((double(ray.ox) - box.lox) / (double(box.hix) - box.lox), 32),
                          cell_of((double(ray.oy) - box.loy) / (double(box.hiy) - box.loy), 32),
                          cell_of((double(ray.oz) - box.loz) / (double(box.hiz) - box.loz), 32)};
    const auto to = octahedral({ray.dx, ray.dy, ray.dz});
    const int direction[2] = {cell_of(to[0], 256), cell_of(to[1], 256)};
    for (const int cell : {start[0], start[1], start[2], direction[0], direction[1]})
        if (cell < 0) return -1;
    std::int64_t key = 0;
    for (int bit = 4; bit >= 0; --bit)
        for (const int cell : start) key = 2 * key + (cell >> bit & 1);
    for (int bit = 7; bit >= 0; --bit)
        for (const int cell : direction) key = 2 * key + (cell >> bit & 1);
    return key;
}

TEST(RayOrder, KeysAreCellsOfStartsAndDirections) {
    const Bvh bvh = cube_of_triangles();
    const Kernel make_keys = load_kernel(device(), "trace/queue/ray_order.cl", "ray_keys");
    for (const std::size_t count : {1u, 15u, 17u, 1024u, 5003u}) {
        std::vector<Ray> rays = random_rays(count, 0.9f, 1.f, 4);
        for (std::size_t i = 0; i < count; i += 3) rays[i].ox *= 3.f, rays[i].oy *= 3.f;  // outside of the box, some
        const Buffer<std::uint32_t> keys(device(), count + 1);
        Kernel(make_keys).run({(count + 1023) / 1024, 1}, state_of(bvh).header, Buffer<Ray>(device(), rays),
                              std::uint32_t(count), keys);
        const std::vector<std::uint32_t> found = keys.read();
        std::size_t told = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t expected = expected_key(rays[i], state_of(bvh).read_header());
            if (expected < 0) continue;
            ++told;
            ASSERT_EQ(found[i], std::uint32_t(expected)) << "ray " << i << " of " << count;
        }
        EXPECT_GE(told, count * 9 / 10);
    }
}

/// Whether rays are worth sorting.
std::uint32_t unordered(const Bvh& bvh, const std::vector<Ray>& rays) {
    Buffer<std::uint32_t> answer(device(), 1);
    answer.fill(7);
    load_kernel(device(), "trace/queue/ray_order.cl", "sample_order")
        .run({1, 1}, state_of(bvh).header, Buffer<Ray>(device(), rays), std::uint32_t(rays.size()), answer);
    return answer.read()[0];
}

TEST(RayOrder, IsMadeOfRaysThatHaveNothingInCommon) {
    const Bvh bvh = cube_of_triangles();
    std::vector<Ray> anywhere = random_rays(3000, 2.f, 1.f, 5), from_one_point = anywhere, along_a_path = anywhere,
                     side_by_side = anywhere;
    for (std::size_t i = 0; i < anywhere.size(); ++i) {
        from_one_point[i].ox = from_one_point[i].oy = from_one_point[i].oz = 0.25f;
        along_a_path[i].ox = 1e-3f * float(i), along_a_path[i].oy = along_a_path[i].oz = 0.f;
        side_by_side[i].dx = 1e-4f * float(i), side_by_side[i].dy = 1.f, side_by_side[i].dz = 0.f;
    }
    EXPECT_EQ(unordered(bvh, anywhere), 1u);
    EXPECT_EQ(unordered(bvh, from_one_point), 1u);
    EXPECT_EQ(unordered(bvh, along_a_path), 0u);  // as those that leave a surface: neighbours begin near each other
    EXPECT_EQ(unordered(bvh, side_by_side), 0u);
    EXPECT_EQ(unordered(bvh, {anywhere[0]}), 0u);
}

/// Every 1024th ray of 512 x 512 is at the end of a row, where the next ray points elsewhere.
TEST(RayOrder, IsNotMadeOfPictures) {
    const Bvh bvh = cube_of_triangles();
    for (const unsigned width : {64, 256, 300, 512})
        for (const unsigned height : {64, 256, 512})
            EXPECT_EQ(unordered(bvh, camera_rays({0, 0, 3}, glm::vec3(0.f), width, height, 1.5f)), 0u)
                << width << " x " << height;
}

/// By a part of the rays that is traced first; the hits are the same.
TEST(RayOrder, IsMadeOfRaysThatTakeLong) {
    if (device().tuning("trace/closest_hit", "SORT_FROM") == 0) GTEST_SKIP() << "this device never sorts rays";
    const std::vector<Ray> rays = random_rays(70'000, 2.f, 1.f, 6);
    std::vector<Hit> hits[2];
    for (const bool sorts : {false, true}) {
        const ScopedTuning least("trace/closest_hit", "SORT_FROM_NANOSECONDS", sorts ? 0 : 4'000'000'000u);
        const Bvh bvh = cube_of_triangles();
        const double before = device().profiler().milliseconds("ray_keys");
        hits[sorts] = closest_hit(bvh, rays);
        EXPECT_EQ(device().profiler().milliseconds("ray_keys") > before, sorts);
    }
    EXPECT_EQ(std::memcmp(hits[0].data(), hits[1].data(), rays.size() * sizeof(Hit)), 0);
}

}  // namespace
}  // namespace claray::test
