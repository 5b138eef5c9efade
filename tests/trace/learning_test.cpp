// Queries learn (host/trace/learning): a tree is replaced by a better one while it is traced.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/compute/contexts.hpp"
#include "host/compute/memory.hpp"
#include "host/trace/learning/better_tree.hpp"
#include "host/trace/learning/learning.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

/// Long triangles askew among small ones: rays are several times as fast with Builder::high, which splits them.
Mesh needles_and_dust() {
    Mesh mesh = soup(2000, 0.02f, 3);
    Random random(5);
    for (int i = 0; i < 300; ++i) {
        const auto first = std::uint32_t(mesh.positions.size());
        const glm::vec3 from = random.in_cube(1.f), to = random.in_cube(1.f);
        mesh.positions.insert(mesh.positions.end(), {from, to, from + random.in_cube(0.01f)});
        mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    return mesh;
}

/// Queries look for a better tree after 16,384 rays or four per triangle, without waiting for the time of builds.
struct EarlySearch {
    const ScopedTuning few_rays{device(), "trace/learning", "RAYS_PER_PIECE", 512};
    const ScopedTuning at_once{device(), "trace/learning", "BUILDS_TO_WAIT_FOR", 0};
};

Bvh build_to_learn(const Mesh& mesh, Builder builder = Builder::fast, std::optional<bool> learns = true) {
    return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .learns = learns});
}

const std::vector<Ray>& rays() {
    static const std::vector<Ray> rays = random_rays(4096, 2.f, 1.f, 7);
    return rays;
}

void trace_until_ended(const Bvh& bvh, const QueryOptions& options = {}) {
    for (int batch = 0; batch < 6; ++batch) static_cast<void>(closest_hit(bvh, rays(), options));
    wait_for_search(bvh);
}

template <class Result>
bool same(const std::vector<Result>& a, const std::vector<Result>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Result)) == 0;
}

TEST(Learning, ReplacesATreeAndKeepsTheHits) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    const Bvh bvh = build_to_learn(mesh);
    const std::vector<Hit> expected = closest_hit(bvh, rays());
    const std::vector<std::uint8_t> occluded = any_hit(bvh, rays());
    Query query(bvh, QueryKind::closest);
    trace_until_ended(bvh);
    ASSERT_TRUE(bvh.is_replaced());
    EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
    EXPECT_TRUE(same(any_hit(bvh, rays()), occluded));
    std::vector<Hit> hits(rays().size());
    query.run(rays(), hits);  // made before, for the first tree
    EXPECT_TRUE(same(hits, expected));
}

TEST(Learning, TheFasterTreeIsChosen) {
    const Mesh mesh = needles_and_dust();
    const Bvh fast = build_to_learn(mesh), high = build_to_learn(mesh, Builder::high);
    RaySample sample(device());
    const Buffer<Ray> batch(device(), random_rays(65'536, 2.f, 1.f, 7));
    sample.add(device(), QueryKind::closest, {}, batch);
    sample.add(device(), QueryKind::any, {}, batch);
    ASSERT_EQ(sample.pieces().size(), 2u);
    const auto go_on = [] { return false; };
    EXPECT_TRUE(is_faster(device(), fast, high, sample.pieces(), go_on));
    EXPECT_FALSE(is_faster(device(), high, fast, sample.pieces(), go_on));
    EXPECT_FALSE(is_faster(device(), fast, high, sample.pieces(), [] { return true; }));
}

TEST(Learning, SampleIsOfTheLatestBatches) {
    const ScopedTuning of_64(device(), "trace/learning", "RAYS_PER_PIECE", 64);
    RaySample sample(device());
    for (int batch = 0; batch < 40; ++batch) {
        std::vector<Ray> rays(100, make_ray({float(batch), 0, 0}, {0, 0, 1}));
        for (std::size_t i = 0; i < rays.size(); ++i) rays[i].oy = float(i);
        sample.add(device(), batch % 2 == 0 ? QueryKind::closest : QueryKind::any, {}, Buffer<Ray>(device(), rays));
    }
    sample.add(device(), QueryKind::any, {}, Buffer<Ray>(device(), std::vector<Ray>(63)));  // too few since the last
    ASSERT_EQ(sample.pieces().size(), RaySample::most_pieces);
    float least_offset = 100, greatest_offset = 0;
    for (const RaySample::Piece& piece : sample.pieces()) {
        const std::vector<Ray> rays = piece.rays.read();
        ASSERT_EQ(rays.size(), 64u);
        EXPECT_GE(rays[0].ox, 24.f);
        EXPECT_EQ(piece.kind == QueryKind::closest, int(rays[0].ox) % 2 == 0);
        EXPECT_EQ(piece.stands_for, 100.0);
        for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(rays[i].oy, rays[0].oy + float(i));
        least_offset = std::min(least_offset, rays[0].oy), greatest_offset = std::max(greatest_offset, rays[0].oy);
    }
    EXPECT_LT(least_offset, 9.f) << "pieces are of all parts of the batches";
    EXPECT_GT(greatest_offset, 27.f);
}

TEST(Learning, OnlyAutomaticTreesLearnUnasked) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    for (const Builder builder : {Builder::fast, Builder::balanced, Builder::high}) {
        const Bvh bvh = build_to_learn(mesh, builder, {});
        trace_until_ended(bvh);
        EXPECT_FALSE(bvh.is_replaced()) << traits_of(builder).name;
    }
    EXPECT_EQ(build_to_learn(mesh, Builder::automatic, {}).state().learns,
              resolve(Builder::automatic, device()) != Builder::high);
    EXPECT_FALSE(build_to_learn(mesh, Builder::automatic, false).state().learns);
    EXPECT_FALSE(build_to_learn(mesh, Builder::high, true).state().learns) << "there is no better builder";
}

TEST(Learning, WaitsUntilTracingTookTenBuilds) {
    const ScopedTuning few_rays(device(), "trace/learning", "RAYS_PER_PIECE", 64);
    const ScopedTuning long_build(device(), "trace/learning", "LEAST_MILLISECONDS", 10'000);
    const Bvh bvh = build_to_learn(needles_and_dust());
    trace_until_ended(bvh);
    EXPECT_FALSE(bvh.is_replaced());
    const ScopedTuning unknown(device(), "plan/model", "HIGH_PICOSECONDS_PER_TRIANGLE", 0);
    EXPECT_TRUE(std::isinf(seconds_to_build_best(device(), 1)));
}

TEST(Learning, QueriesThatItCannotJudgeDoNotCount) {
    const EarlySearch early;
    const Bvh bvh = build_to_learn(needles_and_dust());
    QueryOptions masks, brute_force, visits;
    masks.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>(rays().size(), 1));
    brute_force.brute_force = true;
    visits.visits = Buffer<Visits>(device(), rays().size());
    for (const QueryOptions& options : {masks, brute_force, visits}) trace_until_ended(bvh, options);
    EXPECT_EQ(bvh.state().search, nullptr);
}

/// The first tree is left alone by the search, and stays what `refit` and `rebuild` begin with.
TEST(Learning, MotionReturnsToTheFirstTree) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    for (const bool rebuilds : {false, true}) {
        Bvh bvh = build_to_learn(mesh);
        trace_until_ended(bvh);
        ASSERT_TRUE(bvh.is_replaced());
        Mesh moved = mesh;
        for (glm::vec3& p : moved.positions) p.x += 0.25f;
        Buffer<float> positions = bvh.triangles().positions;
        positions.write({&moved.positions[0].x, 3 * moved.positions.size()});
        rebuilds ? bvh.rebuild() : bvh.refit();
        EXPECT_FALSE(bvh.is_replaced());
        const std::vector<Hit> expected = closest_hit(build_to_learn(moved), rays());
        EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
        trace_until_ended(bvh);
        EXPECT_FALSE(bvh.is_replaced()) << "for good";
    }
}

/// The buffers of positions may be used for something else once the tree is built.
TEST(Learning, TrianglesAreThoseOfTheTree) {
    const EarlySearch early;
    Mesh dust = soup(500, 0.05f, 2), needles = needles_and_dust();
    dust.mask = 4;
    needles.positions[7].y = std::numeric_limits<float>::quiet_NaN();
    needles.positions[31] = needles.positions[30];
    const std::vector<Mesh> meshes = {dust, needles};
    const Bvh bvh = Bvh::build(device(), meshes, {.builder = Builder::fast, .learns = true});
    const std::vector<Hit> expected = closest_hit(bvh, rays());
    QueryOptions masked;
    masked.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>(rays().size(), 4));
    const std::vector<Hit> expected_masked = closest_hit(bvh, rays(), masked);
    Buffer<float>(bvh.triangles().positions).fill(0);
    const TriangleBuffers held = triangles_held(device(), bvh);
    const Bvh again = Bvh::build(device(), held);
    EXPECT_EQ(again.statistics().culled, bvh.statistics().culled);
    EXPECT_GT(again.statistics().culled, 0u);
    EXPECT_TRUE(same(closest_hit(again, rays()), expected));
    EXPECT_TRUE(same(closest_hit(again, rays(), masked), expected_masked));
    trace_until_ended(bvh);
    ASSERT_TRUE(bvh.is_replaced());
    EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
}

TEST(Learning, ATreeMayEndOrMoveDuringTheSearch) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    for (int i = 0; i < 4; ++i) {
        Bvh bvh = build_to_learn(mesh);
        for (int batch = 0; batch < 3; ++batch) static_cast<void>(closest_hit(bvh, rays()));
        if (i % 2 == 0) {
            bvh.refit();
            EXPECT_FALSE(bvh.is_replaced());
            wait_for_search(bvh);
            EXPECT_FALSE(bvh.is_replaced());
        }
    }
}

TEST(Learning, TooLittleMemoryOnlyEndsTheSearch) {
    const EarlySearch early;
    const Device own = device().with_new_queue();
    const Mesh mesh = needles_and_dust();
    const Bvh bvh = Bvh::build(own, std::span(&mesh, 1), {.builder = Builder::fast, .learns = true});
    const Buffer<Ray> batch(own, rays());
    Buffer<Hit> hits(own, rays().size());
    closest_hit(bvh, batch, hits);
    const std::vector<Hit> expected = hits.read();
    fail_allocation(own, 1);
    for (int run = 0; run < 6; ++run) closest_hit(bvh, batch, hits);
    fail_allocation(own, 0);
    wait_for_search(bvh);
    EXPECT_FALSE(bvh.is_replaced());
    EXPECT_TRUE(same(hits.read(), expected));
}

TEST(Learning, ThreadsWithQueuesOfTheirOwn) {
    const EarlySearch early;
    const Bvh bvh = build_to_learn(needles_and_dust());
    const std::vector<Hit> expected = closest_hit(bvh, rays());
    std::vector<Device> queues;
    for (int i = 0; i < 3; ++i) queues.push_back(device().with_new_queue());
    std::vector<unsigned> wrong(queues.size());
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < queues.size(); ++i)
        threads.emplace_back([&, i] {
            Query query(bvh, QueryKind::closest, {}, queues[i]);
            std::vector<Hit> hits(rays().size());
            for (int batch = 0; batch < 40; ++batch) {
                query.run(rays(), hits);
                wrong[i] += !same(hits, expected);
            }
        });
    for (std::thread& thread : threads) thread.join();
    wait_for_search(bvh);
    EXPECT_TRUE(bvh.is_replaced());
    EXPECT_EQ(wrong, std::vector<unsigned>(queues.size()));
}

}  // namespace
}  // namespace claray::test
