// The arithmetic of the benchmark, and that it measures the stated quantities.
#include "host/measure/bench.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/measure/explain.hpp"
#include "host/measure/rays.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::measure {
namespace {

TEST(Measure, MedianAndSpread) {
    EXPECT_EQ(median({}), 0);
    EXPECT_EQ(median({3}), 3);
    EXPECT_EQ(median({9, 1, 5}), 5);
    EXPECT_EQ(median({5, 1, 4, 2, 3, 100, 0}), 3);
    EXPECT_EQ(relative_spread({}), 0);
    EXPECT_EQ(relative_spread({4, 4, 4, 4}), 0);
    EXPECT_DOUBLE_EQ(relative_spread({6, 10, 8, 12, 14}), 0.2);  // quartiles 8 and 12 about 10
}

TEST(Measure, RoundsRunEveryTaskByTurns) {
    std::string order;
    Buffer<std::uint32_t> buffer(test::device(), 1000);
    const auto timings =
        measure_rounds(test::device(), 3,
                       {[&] { order += 'a', buffer.fill(1); },
                        [&] { order += 'b', buffer.fill(2), (void)buffer.read(); }, [&] { order += 'c'; }});
    EXPECT_EQ(order, "abcabcabcabc") << "one round to warm up, three that count";
    ASSERT_EQ(timings.size(), 3u);
    EXPECT_EQ(timings[0].commands.size(), 1u);
    EXPECT_EQ(timings[1].commands.count("fill_buffer") + timings[1].commands.count("read_buffer"), 2u);
    for (const Timing& timing : timings) EXPECT_EQ(timing.rounds.size(), 3u);
    for (int round = 0; round < 3; ++round)
        EXPECT_GE(timings[1].spans[std::size_t(round)], 0.999999 * timings[1].rounds[std::size_t(round)]);
    EXPECT_EQ(timings[2].milliseconds(), 0) << "no command, no time";
}

TEST(WorldMeshes, AreAllThatIsSeen) {
    Scene scene;
    scene.meshes = {test::soup(3, 0.5f, 1), test::soup(4, 0.5f, 2)};
    EXPECT_EQ(world_meshes(scene).size(), 2u);
    glm::mat4 mirrored(2.f);
    mirrored[0][0] = -2.f, mirrored[3] = {5.f, 0.f, 0.f, 1.f};
    scene.instances = {{1}, {1}};
    scene.instances[1].transform = mirrored;
    const std::vector<Mesh> meshes = world_meshes(scene);
    ASSERT_EQ(meshes.size(), 2u) << "what no instance places is not seen";
    EXPECT_EQ(meshes[0].positions, scene.meshes[1].positions);
    const glm::vec3 p = scene.meshes[1].positions[3];
    EXPECT_EQ(meshes[1].positions[3], glm::vec3(5.f - 2.f * p.x, 2.f * p.y, 2.f * p.z));
    EXPECT_EQ(meshes[1].triangles.size(), 4u);
}

TEST(WorldMeshes, OfABuiltInScene) {
    std::size_t triangles = 0;
    for (const Mesh& mesh : load_meshes("effect:instances")) triangles += mesh.triangles.size();
    EXPECT_EQ(triangles, 2u + 25u * 1280u);
}

PresetResult preset(const std::string& name, double build, double ms_per_million) {
    PresetResult result;
    result.preset = name;
    result.build.spans = {build};
    result.kinds = {{"bounce", 1'000'000, {}}};
    result.kinds[0].timing.rounds = {ms_per_million};
    return result;
}

TEST(BuildAndTrace, QuickestPresetsAreThoseOfEveryNumberOfRays) {
    const std::vector<std::vector<PresetResult>> cases = {
        {preset("fast", 1, 10)},
        {preset("fast", 1, 10), preset("balanced", 5, 8), preset("high", 50, 7)},
        {preset("fast", 1, 10), preset("balanced", 5, 9.9), preset("high", 6, 5)},  // the second never wins
        {preset("fast", 1, 10), preset("balanced", 0.5, 8)},
        {preset("high", 3, 2), preset("fast", 3, 9), preset("same", 3, 2)},
    };
    for (const auto& presets : cases) {
        const SceneResult scene{"", 0, presets};
        const std::vector<Winner> winners = quickest_presets(scene, 0);
        ASSERT_FALSE(winners.empty());
        EXPECT_EQ(winners[0].from_rays, 0);
        for (double rays = 1; rays < 1e10; rays *= 1.37) {
            double least = INFINITY, of_winner = INFINITY;
            for (const PresetResult& p : presets) least = std::min(least, build_and_trace(p, 0, rays));
            std::string winner;
            for (const Winner& w : winners)
                if (w.from_rays <= rays) winner = w.preset;
            for (const PresetResult& p : presets)
                if (p.preset == winner) of_winner = build_and_trace(p, 0, rays);
            EXPECT_NEAR(of_winner, least, 1e-9 * least) << winner << " at " << rays;
        }
    }
    EXPECT_EQ(quickest_presets({"", 0, cases[2]}, 0).size(), 2u);
    EXPECT_DOUBLE_EQ(build_and_trace(cases[0][0], 0, 2.5e6), 26);
}

TEST(Rays, ShadowAndBounceRaysStartAtTheHitsOfPrimaryRays) {
    Scene scene;
    scene.meshes = {test::sphere(3)};
    const std::vector<View> views = three_views("ball", scene);
    ASSERT_EQ(views.size(), 3u);
    const RaySets sets = make_rays(test::device(), scene, views, 32, 24);
    ASSERT_EQ(sets.primary.size(), 3u * 32 * 24);
    ASSERT_GT(sets.shadow.size(), 100u);
    ASSERT_EQ(sets.shadow.size(), sets.bounce.size());
    EXPECT_EQ(sets.mixed.size(), sets.primary.size() + sets.bounce.size());
    for (std::size_t i = 0; i < sets.bounce.size(); ++i) {
        const Ray& bounce = sets.bounce[i];
        const glm::vec3 from(bounce.ox, bounce.oy, bounce.oz), direction(bounce.dx, bounce.dy, bounce.dz);
        ASSERT_NEAR(glm::length(from), 1.f, 0.02f) << "on the sphere";
        ASSERT_GT(glm::dot(direction, from), -0.15f) << "outwards";
        const Ray& shadow = sets.shadow[i];
        const glm::vec3 light = glm::vec3(shadow.ox, shadow.oy, shadow.oz) +
                                glm::vec3(shadow.dx, shadow.dy, shadow.dz) * (shadow.tmax / 0.9999f);
        ASSERT_NEAR(glm::distance(light, views[0].light), 0.f, 1e-3f) << "ends at the light";
    }
    // Convex: no bounce meets the sphere again.
    for (const Hit& hit : closest_hit(Bvh::build(test::device(), scene.meshes), sets.bounce))
        ASSERT_EQ(hit.primitive, CLARAY_MISS);
}

TEST(Bench, MeasuresEveryPresetAndKind) {
    BenchOptions options;
    options.presets = {Builder::balanced, Builder::fast};
    options.width = 24, options.height = 16, options.repeat = 2;
    const SceneResult result = SceneBench(test::device(), "soup:300", options).run();
    EXPECT_EQ(result.triangles, 300u);
    ASSERT_EQ(result.presets.size(), 2u);
    EXPECT_EQ(result.presets[0].preset, "balanced");
    EXPECT_EQ(result.presets[1].preset, "fast");
    for (const PresetResult& p : result.presets) {
        EXPECT_EQ(p.statistics.triangles, 300u);
        EXPECT_GT(p.build.milliseconds(), 0);
        EXPECT_GE(p.build.span(), 0.999999 * p.build.milliseconds());
        ASSERT_EQ(p.kinds.size(), 4u);
        EXPECT_EQ(p.kinds[0].rays, 3u * 24 * 16);
        for (const auto& kind : p.kinds) {
            EXPECT_GE(kind.timing.commands.size(), 1u) << kind.name;
            EXPECT_DOUBLE_EQ(kind.mrays_per_second() * kind.timing.milliseconds(), 1e-3 * double(kind.rays));
        }
    }
    const std::string csv = bench_csv(test::device().info(), result), header = bench_csv_header();
    const auto count = [](const std::string& text, char c) { return std::count(text.begin(), text.end(), c); };
    EXPECT_EQ(count(csv, ','), count(csv, '\n') * count(header, ',')) << "every row has all columns";
}

TEST(Bench, TracesTreesAsTheyAreBuilt) {
    BenchOptions options;
    options.presets = {Builder::high};  // splits triangles, so that a refit grows their boxes
    options.width = 8, options.height = 8, options.repeat = 2;
    const SceneResult result = SceneBench(test::device(), "cornell", options).run();
    const Bvh built = Bvh::build(test::device(), load_meshes("cornell"), {.builder = Builder::high});
    EXPECT_EQ(result.presets.at(0).statistics.sah_cost, built.statistics().sah_cost);
}

/// 100 rays per round.
SceneResult result_of(const std::vector<double>& milliseconds) {
    PresetResult preset;
    preset.preset = "fast";
    for (const double ms : milliseconds) {
        PresetResult::Kind kind{"kind " + std::to_string(preset.kinds.size()), 100, {}};
        kind.timing.rounds = {ms};
        preset.kinds.push_back(kind);
    }
    return {"scene", 1, {preset}};
}

TEST(Bench, AddsTheRaysOfDevicesAtOnce) {
    const auto results = joint_results({result_of({1, 0.1}), result_of({2, 0.1})},   // 0.1, 1; 0.05, 1 Mrays/s
                                       {result_of({1, 0.2}), result_of({4, 0.1})});  // 0.1, 0.5; 0.025, 1
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].preset, "fast");
    ASSERT_EQ(results[0].kinds.size(), 2u);
    EXPECT_EQ(results[0].kinds[1].name, "kind 1");
    EXPECT_DOUBLE_EQ(results[0].kinds[0].mrays_per_second, 0.125);
    EXPECT_DOUBLE_EQ(results[0].kinds[0].share, 0.125 / 0.15);
    EXPECT_DOUBLE_EQ(results[0].kinds[1].mrays_per_second, 1.5);
    EXPECT_DOUBLE_EQ(results[0].kinds[1].share, 0.75);
}

TEST(Bench, MeasuresDevicesAtOnce) {
    BenchOptions options;
    options.presets = {Builder::fast};
    options.width = 24, options.height = 16, options.repeat = 1;
    std::vector<SceneBench> benches;
    for (const int rounds : {1, 40}) {
        options.repeat = rounds;
        benches.emplace_back(Device::open(std::to_string(test::device().info().index)), "soup:300", options);
    }
    const std::vector<SceneResult> results = run_at_once(benches);
    ASSERT_EQ(results.size(), 2u);
    EXPECT_EQ(results[0].presets.at(0).kinds.at(0).timing.rounds.size(), 1u);
    EXPECT_EQ(results[1].presets.at(0).kinds.at(0).timing.rounds.size(), 40u);
    for (const SceneResult& result : results)
        for (const auto& kind : result.presets[0].kinds) EXPECT_GT(kind.mrays_per_second(), 0) << kind.name;
}

TEST(Explain, TellsNoiseFromCost) {
    EXPECT_TRUE(is_noise({1.1, 0.9, 1.2, 1.1, 1.1, 1.1, 1.1}));
    EXPECT_FALSE(is_noise({1.1, 1.01, 1.2, 1.1, 1.1, 1.1, 1.1}));
    EXPECT_FALSE(is_noise({0.1, 0.9, 0.2, 0.9, 0.8}));
    EXPECT_TRUE(is_noise({0.1, 0.9, 0.2, 0.9})) << "too few";
    EXPECT_FALSE(is_noise({1.1, 0.9, 1.2, 1.1, 1.1, 1.1, 1.1, 1.2})) << "one of eight";
    EXPECT_TRUE(is_noise({1.1, 0.9, 1.2, 1.1, 1.1, 1.1, 0.8, 1.2}));
    EXPECT_TRUE(is_noise({0.9, 1.1}));
}

}  // namespace
}  // namespace claray::measure
