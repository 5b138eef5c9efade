// Queries learn (host/trace/learning): a tree is replaced by a better one while it is traced.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <thread>

#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/compute/contexts.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/memory.hpp"
#include "host/trace/learning/better_tree.hpp"
#include "host/trace/learning/comparison.hpp"
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

/// Queries look for a better tree after 100 batches, without waiting for the time of builds.
struct EarlySearch {
    const ScopedTuning at_once{device(), "trace/learning", "BUILDS_TO_WAIT_FOR", 0};
};

Bvh build_to_learn(const Mesh& mesh, Builder builder = Builder::fast, std::optional<bool> learns = true) {
    return Bvh::build(device(), std::span(&mesh, 1), {.builder = builder, .learns = learns});
}

const std::vector<Ray>& rays() {
    static const std::vector<Ray> rays = random_rays(2048, 2.f, 1.f, 7);
    return rays;
}

void trace(const Bvh& bvh, int batches, const QueryOptions& options = {}) {
    for (int batch = 0; batch < batches; ++batch) static_cast<void>(closest_hit(bvh, rays(), options));
}

void trace_until_ended(const Bvh& bvh, const QueryOptions& options = {}) {
    trace(bvh, 110, options);
    wait_for_build(bvh);
    trace(bvh, 40, options);
}

/// A structure whose tree was replaced. Other work on the machine can disturb a comparison: then another one tries.
Bvh replaced(const std::function<Bvh()>& build) {
    Bvh bvh = build();
    for (int tries = 1; trace_until_ended(bvh), !is_replaced(bvh) && tries < 50; ++tries) bvh = build();
    return bvh;
}

template <class Result>
bool same(const std::vector<Result>& a, const std::vector<Result>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Result)) == 0;
}

TEST(Learning, ReplacesATreeAndKeepsTheHits) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    const Bvh first = build_to_learn(mesh, Builder::fast, false);
    const std::vector<Hit> expected = closest_hit(first, rays());
    const std::vector<std::uint8_t> occluded = any_hit(first, rays());
    std::optional<Query> query;  // made before the tree is replaced
    const Bvh bvh = replaced([&] {
        const Bvh learning = build_to_learn(mesh);
        query.emplace(learning, QueryKind::closest);
        return learning;
    });
    ASSERT_TRUE(is_replaced(bvh));
    EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
    EXPECT_TRUE(same(any_hit(bvh, rays()), occluded));
    std::vector<Hit> hits(rays().size());
    query->run(rays(), hits);
    EXPECT_TRUE(same(hits, expected));
}

TEST(Learning, ComparisonIsOfAllTimesAndOfTheOneInTheMiddle) {
    Comparison comparison;
    EXPECT_EQ(comparison.median(), 1);
    EXPECT_EQ(comparison.mean(), 1);
    comparison.add(4, 2);
    EXPECT_EQ(comparison.median(), 0.5);
    for (int i = 0; i < 3; ++i) comparison.add(1, 2);
    EXPECT_EQ(comparison.median(), 2) << "three of five seconds are slower";
    EXPECT_NEAR(comparison.mean(), 8.0 / 7, 1e-12);
    comparison.add(4, 2);
    EXPECT_EQ(comparison.median(), 0.5) << "and now three of seven";
    EXPECT_NEAR(comparison.mean(), 10.0 / 11, 1e-12);
    EXPECT_TRUE(comparison.second_pays());
    comparison.add(1, 1000);
    EXPECT_EQ(comparison.median(), 0.5) << "a disturbed batch weighs as little as others";
    EXPECT_NEAR(comparison.mean(), 12.0 / 12, 1e-12);
    EXPECT_FALSE(comparison.second_pays()) << "the mean must agree";
    comparison.add(0, 1), comparison.add(1, 0), comparison.add(-1, -1);
    EXPECT_EQ(comparison.size(), 6u) << "times that a clock that steps back gives do not count";
}

TEST(Learning, MeanOfADisturbedFirstTree) {
    Comparison comparison;
    for (int i = 0; i < 9; ++i) comparison.add(1, 1.05);
    comparison.add(1000, 1);
    EXPECT_NEAR(comparison.mean(), (9 * 1.05 + 2 * 0.5) / 11, 1e-12);
    EXPECT_LT(comparison.mean(), 0.97);
    EXPECT_FALSE(comparison.second_pays()) << "the median must agree";
}

TEST(Learning, ASmallGainIsNotWorthTheMemory) {
    for (const double seconds : {0.5, 0.96, 0.98, 1.0, 1.5}) {
        Comparison comparison;
        comparison.add(1, seconds);
        EXPECT_EQ(comparison.second_pays(), seconds < 0.97) << seconds;
    }
}

TEST(Learning, OnlyAutomaticTreesLearnUnasked) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    for (const Builder builder : {Builder::fast, Builder::balanced, Builder::high}) {
        const Bvh bvh = build_to_learn(mesh, builder, {});
        trace_until_ended(bvh);
        EXPECT_FALSE(is_replaced(bvh)) << traits_of(builder).name;
    }
    EXPECT_EQ(state_of(build_to_learn(mesh, Builder::automatic, {})).learns,
              resolve(Builder::automatic, device()) != Builder::high);
    EXPECT_FALSE(state_of(build_to_learn(mesh, Builder::automatic, false)).learns);
    EXPECT_FALSE(state_of(build_to_learn(mesh, Builder::high, true)).learns) << "there is no better builder";
}

TEST(Learning, WaitsUntilTracingTookTenBuilds) {
    const ScopedTuning long_build(device(), "trace/learning", "LEAST_MILLISECONDS", 10'000);
    const Bvh bvh = build_to_learn(needles_and_dust());
    trace_until_ended(bvh);
    EXPECT_FALSE(is_replaced(bvh));
}

TEST(Learning, DevicesWithoutAModelCountAMicrosecondATriangle) {
    const Device own = device().with_new_queue();
    state_of(own).tuning.erase("plan/model HIGH_PICOSECONDS_PER_TRIANGLE");
    EXPECT_DOUBLE_EQ(seconds_to_build_best(own, 2'000'000), 2.0);
    state_of(own).tuning["plan/model HIGH_PICOSECONDS_PER_TRIANGLE"] = 500'000;
    EXPECT_DOUBLE_EQ(seconds_to_build_best(own, 2'000'000), 1.0);
    EXPECT_DOUBLE_EQ(seconds_to_build_best(own, 1), 1e-3 * device().tuning("trace/learning", "LEAST_MILLISECONDS"));
}

TEST(Learning, QueriesThatItCannotJudgeDoNotCount) {
    const EarlySearch early;
    const Bvh bvh = build_to_learn(needles_and_dust());
    QueryOptions masks, brute_force, visits;
    masks.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>(rays().size(), 1));
    brute_force.brute_force = true;
    visits.visits = Buffer<Visits>(device(), rays().size());
    for (const QueryOptions& options : {masks, brute_force, visits}) trace(bvh, 3, options);
    EXPECT_EQ(state_of(bvh).search(), nullptr);
}

/// The first tree is left alone by the search, and stays what `refit` and `rebuild` begin with.
TEST(Learning, MotionReturnsToTheFirstTree) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    for (const bool rebuilds : {false, true}) {
        Bvh bvh = replaced([&] { return build_to_learn(mesh); });
        ASSERT_TRUE(is_replaced(bvh));
        Mesh moved = mesh;
        for (glm::vec3& p : moved.positions) p.x += 0.25f;
        Buffer<float> positions = bvh.triangles().positions;
        positions.write({&moved.positions[0].x, 3 * moved.positions.size()});
        rebuilds ? bvh.rebuild() : bvh.refit();
        EXPECT_FALSE(is_replaced(bvh));
        const std::vector<Hit> expected = closest_hit(build_to_learn(moved), rays());
        EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
        trace_until_ended(bvh);
        EXPECT_FALSE(is_replaced(bvh)) << "for good";
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
    const auto build_learning = [&] {
        return Bvh::build(device(), meshes, {.builder = Builder::fast, .learns = true});
    };
    const Bvh bvh = build_learning();
    const std::vector<Hit> expected = closest_hit(bvh, rays());
    QueryOptions masked;
    masked.ray_masks = Buffer<std::uint32_t>(device(), std::vector<std::uint32_t>(rays().size(), 4));
    const std::vector<Hit> expected_masked = closest_hit(bvh, rays(), masked);
    Buffer<float>(bvh.triangles().positions).fill(0);
    const Bvh again = build_best(device(), read_triangles(device(), bvh), {.layout = Layout::binary});
    EXPECT_EQ(state_of(again).read_header().culled, state_of(bvh).read_header().culled);
    EXPECT_GT(state_of(again).read_header().culled, 0u);
    EXPECT_EQ(state_of(again).nodes.size(), state_of(again).read_header().inner_nodes)
        << "memory that is not needed is freed";
    EXPECT_EQ(state_of(again).leaves.size(), state_of(again).read_header().valid);
    EXPECT_TRUE(same(closest_hit(again, rays()), expected));
    EXPECT_TRUE(same(closest_hit(again, rays(), masked), expected_masked));
    const Bvh other = replaced([&] {
        const Bvh learning = build_learning();
        Buffer<float>(learning.triangles().positions).fill(0);
        return learning;
    });
    ASSERT_TRUE(is_replaced(other));
    EXPECT_TRUE(same(closest_hit(other, rays()), expected));
}

TEST(Learning, ATreeMayEndOrMoveDuringTheSearch) {
    const EarlySearch early;
    const Mesh mesh = needles_and_dust();
    for (int i = 0; i < 4; ++i) {
        Bvh bvh = build_to_learn(mesh);
        trace(bvh, 102);
        if (i % 2 == 0) {
            bvh.refit();
            trace_until_ended(bvh);
            EXPECT_FALSE(is_replaced(bvh));
        }
    }
}

TEST(Learning, TooLittleMemoryOnlyEndsTheSearch) {
    const EarlySearch early;
    const Device own = device().with_new_queue();
    const Mesh mesh = needles_and_dust();
    const Bvh bvh = Bvh::build(own, std::span(&mesh, 1), {.builder = Builder::fast, .learns = true});
    const std::vector<Hit> expected = closest_hit(bvh, rays());
    const BvhMemory needed = Bvh::memory_needed(own, 3 * bvh.triangle_count(), bvh.triangle_count(),
                                                {.builder = Builder::high, .layout = bvh.layout()});
    state_of(own).info.memory = bytes_in_use(own) + needed.bytes * 3 / 2;  // half of it is not enough
    trace_until_ended(bvh);
    EXPECT_NE(state_of(bvh).search(), nullptr);
    EXPECT_FALSE(is_replaced(bvh));
    EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
}

/// Batches whose times were not read yet do not keep the structure alive.
TEST(Learning, MemoryIsFreed) {
    const std::uint64_t before = bytes_in_use(device());
    for (int batches = 4; batches < 16; ++batches) {
        const Bvh bvh = build_to_learn(soup(50, 0.1f, 1));
        trace(bvh, batches);
    }
    EXPECT_EQ(bytes_in_use(device()), before);
}

TEST(Learning, QueuesWithoutTimesOnlyEndTheSearch) {
    const EarlySearch early;
    const cl::CommandQueue plain(device().context(), state_of(device()).device);
    const Device adopted = Device::adopt(device().context()(), plain());
    adopted.set_tuning("trace/learning", "BUILDS_TO_WAIT_FOR", 0);
    const Mesh mesh = needles_and_dust();
    const Bvh bvh = Bvh::build(adopted, std::span(&mesh, 1), {.builder = Builder::fast, .learns = true});
    const std::vector<Hit> expected = closest_hit(bvh, rays());
    trace_until_ended(bvh);
    EXPECT_FALSE(is_replaced(bvh));
    EXPECT_TRUE(same(closest_hit(bvh, rays()), expected));
}

TEST(Learning, TheFirstTreeAnswersIfTheOtherCannot) {
    const EarlySearch early;
    const Bvh bvh = build_to_learn(needles_and_dust());
    int failures = 0;
    for (int batch = 0; batch < 130; ++batch) {
        if (batch == 110) wait_for_build(bvh);
        bool answered = false;
        trace_and_learn(device(), bvh, {}, 1, {}, [&](const Bvh& tree) {
            if (&state_of(tree) != &state_of(bvh)) ++failures, throw Error(ErrorKind::device, "out of device memory");
            answered = true;
        });
        device().finish();
        EXPECT_TRUE(answered) << batch;
    }
    EXPECT_EQ(failures, 1);
    EXPECT_FALSE(is_replaced(bvh));
}

/// As many as are wanted are traced twice, even if the program never waits for a batch.
TEST(Learning, ComparesFewBatchesThatAreEnqueued) {
    const EarlySearch early;
    const Device own = device().with_new_queue();
    const Mesh mesh = needles_and_dust();
    const Bvh bvh = Bvh::build(own, std::span(&mesh, 1), {.builder = Builder::fast, .learns = true});
    trace(bvh, 101);  // the last begins the build
    wait_for_build(bvh);
    const Buffer<Ray> batch(own, rays());
    Buffer<Hit> hits(own, rays().size());
    cl::UserEvent begin(own.context());
    const cl::Event begins[] = {begin};
    own.finish();
    own.wait_for(begins);
    own.profiler().reset();
    QueryOptions coherent;
    coherent.coherence = Coherence::coherent;
    for (int i = 0; i < 60; ++i) closest_hit(bvh, batch, hits, coherent);
    begin.setStatus(CL_COMPLETE);
    EXPECT_EQ(own.profiler().summary().at("closest_hit").count, 68u);
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
            for (int batch = 0; batch < 140; ++batch) {
                query.run(rays(), hits);
                wrong[i] += !same(hits, expected);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_NE(state_of(bvh).search(), nullptr);
    EXPECT_EQ(wrong, std::vector<unsigned>(queues.size()));
}

}  // namespace
}  // namespace claray::test
