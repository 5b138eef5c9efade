// The kernel of whole paths, render/trace_paths.cl, makes the same image as the stages, bit for bit, and only if
// requested.
#include <gtest/gtest.h>

#include <array>

#include "claray/effects.hpp"
#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// A device that traces whole paths in scenes with at most this many effects and surfaces per path.
Device following(unsigned most_effects, unsigned most_bounces_permille, unsigned patience = 0) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.set_tuning("render/trace_paths", "MOST_EFFECTS", most_effects);
    fresh.set_tuning("render/trace_paths", "MOST_BOUNCES_PERMILLE", most_bounces_permille);
    fresh.set_tuning("render/trace_paths", "PATIENCE_MILLISECONDS", patience);
    return fresh;
}

RenderConfig small_config() {
    RenderConfig config{.width = 24, .height = 20, .spp = 4, .max_depth = 4};
    config.bvh.layout = Layout::binary;
    return config;
}

Scene scene_named(const std::string& name) { return builtin_scene(name).value(); }

/// Those of the scenes that are compared, so that one kernel of each kind compiles for all of them.
EffectSet effects_of_all() {
    EffectSet all;
    for (const char* name : {"effect:glass", "effect:sky", "effect:mip-maps", "effect:cut-outs", "effect:culling",
                             "effect:many-lights", "effect:hot-spots"})
        all = all | effects_of(scene_named(name));
    return all - EffectSet{Effect::cut_outs, Effect::culling};  // of which traversal would know
}

void expect_same(const std::string& name, EffectSet more) {
    const Scene scene = scene_named(name);
    RenderConfig config = small_config();
    config.effects.add = more;
    const Device whole = following(99, 100'000), staged = following(0, 0);
    Renderer one(whole, scene, config), many(staged, scene, config);
    (void)one.render(), (void)many.render();
    EXPECT_EQ(one.image(), many.image()) << name;
    const RenderStatistics a = one.statistics(), b = many.statistics();
    EXPECT_GT(a.in_paths.rays, 0u) << name;
    EXPECT_EQ(b.in_paths.rays, 0u) << name;
    EXPECT_EQ(a.camera.rays, b.camera.rays) << name;
    EXPECT_EQ(a.bounce.rays, b.bounce.rays) << name;
    EXPECT_EQ(a.shadow.rays, b.shadow.rays) << name;
}

TEST(WholePaths, MakeTheSameImage) {
    expect_same("cornell", {});
    for (const char* name : {"effect:glass", "effect:sky"}) expect_same(name, effects_of_all());
}

TEST(WholePaths, AreAsLongAsThoseOfTheStages) {
    const Scene scene = scene_named("cornell");
    const auto rays_of = [&](unsigned most_effects, unsigned depth) {
        RenderConfig config = small_config();
        config.max_depth = depth;
        Renderer renderer(following(most_effects, 100'000), scene, config);
        (void)renderer.render();
        const RenderStatistics s = renderer.statistics();
        return std::array{s.camera.rays, s.bounce.rays, s.shadow.rays};
    };
    std::uint64_t before = 0;
    for (unsigned depth = 1; depth <= 7; ++depth) {
        const auto rays = rays_of(0, depth);
        EXPECT_EQ(rays_of(99, depth), rays) << depth;
        EXPECT_GT(rays[1], before) << depth;
        before = rays[1];
    }
}

TEST(WholePaths, KnowTexturesCutOutsAndManyLights) {
    for (const char* name :
         {"effect:mip-maps", "effect:cut-outs", "effect:culling", "effect:many-lights", "effect:hot-spots"})
        expect_same(name, effects_of_all());
}

TEST(WholePaths, HeedMacrosOfShading) {
    const Scene scene = scene_named("cornell");
    const auto image_by = [&](unsigned most_effects, unsigned techniques) {
        const Device fresh = following(most_effects, 100'000);
        fresh.set_tuning("render/shade_surface", "TECHNIQUES", techniques);
        Renderer renderer(fresh, scene, small_config());
        (void)renderer.render();
        return renderer.image();
    };
    EXPECT_EQ(image_by(99, 1), image_by(0, 1));
    EXPECT_NE(image_by(99, 1), image_by(99, 3));
}

/// Without it they would be loaded after a part of the patience, which no test lasts.
TEST(WholePaths, AreCompiledBeforehandIfAsked) {
    const Device patient = following(99, 100'000, 360'000'000);
    for (const bool asks : {false, true}) {
        Renderer renderer(patient, scene_named("cornell"), small_config());
        (void)renderer.render_for(0);
        if (asks) renderer.load_kernels();
        (void)renderer.render();
        const RenderStatistics statistics = renderer.statistics();
        EXPECT_EQ(statistics.in_paths.rays > 0, asks);
        const RenderConfig config = small_config();
        EXPECT_EQ(statistics.camera.rays, std::uint64_t(config.width) * config.height * config.spp);
    }
}

/// The last paths of each batch, by render/finish_paths.cl.
TEST(LastPaths, MakeTheSameImage) {
    for (const char* name : {"cornell", "effect:glass", "effect:sky", "effect:mip-maps", "effect:cut-outs",
                             "effect:many-lights", "effect:hot-spots"}) {
        const Scene scene = scene_named(name);
        Device finishing = following(99, 0);
        finishing.set_tuning("render/finish_paths", "MOST_PATHS_PER_UNIT", 65536);
        finishing.profiler().enable(true);
        const Device staged = following(0, 0);
        RenderConfig config = small_config();
        config.max_depth = 9;
        if (name != std::string("cornell")) config.effects.add = effects_of_all();
        for (const unsigned bounces_per_look : {1u, 3u}) {
            finishing.set_tuning("render/wavefront", "BOUNCES_PER_LOOK", bounces_per_look);
            Renderer one(finishing, scene, config), many(staged, scene, config);
            (void)one.render(), (void)many.render();
            EXPECT_EQ(one.image(), many.image()) << name;
            const RenderStatistics a = one.statistics(), b = many.statistics();
            EXPECT_EQ(a.in_paths.rays, 0u) << name;
            EXPECT_EQ(a.camera.rays, b.camera.rays) << name;
            EXPECT_EQ(a.bounce.rays, b.bounce.rays) << name;
            EXPECT_EQ(a.shadow.rays, b.shadow.rays) << name;
        }
        EXPECT_TRUE(finishing.profiler().summary().contains("finish_paths")) << name;
    }
}

TEST(WholePaths, AreForFewEffectsAndShortPaths) {
    const Scene scene = scene_named("cornell");  // two effects, and nearly two surfaces a path after the first
    const auto follows = [&](unsigned effects, unsigned permille) {
        Renderer renderer(following(effects, permille), scene, small_config());
        (void)renderer.render();
        return renderer.statistics().in_paths.rays > 0;
    };
    EXPECT_TRUE(follows(2, 3000));
    EXPECT_FALSE(follows(1, 3000));
    EXPECT_FALSE(follows(2, 1000));
}

/// A device for which batches slightly above `least` paths are small, but batches of twice as many are not.
Device with_small_batches_of(std::uint64_t least) {
    const Device fresh = following(99, 100'000);
    const unsigned units = fresh.info().compute_units;
    fresh.set_tuning("render/trace_paths", "MOST_PATHS_PER_UNIT", unsigned(least / units + 1));
    return fresh;
}

TEST(WholePaths, AreForSmallBatches) {
    const auto follows = [&](std::uint64_t small_batch) {
        Renderer renderer(with_small_batches_of(small_batch), scene_named("effect:sky"), small_config());
        (void)renderer.render();
        return renderer.statistics().in_paths.rays > 0;
    };
    EXPECT_TRUE(follows(2 * 24 * 20)) << "the largest pass: two of four samples";
    EXPECT_FALSE(follows(24 * 20));
}

TEST(WholePaths, LeaveLargerBatchesToTheStages) {
    const Scene scene = scene_named("effect:sky");
    Renderer some(with_small_batches_of(24 * 20), scene, small_config()), none(following(0, 0), scene, small_config());
    (void)some.render();
    EXPECT_EQ(some.statistics().in_paths.rays, 0u);
    some.restart(1, 2);
    (void)some.render();  // passes of one sample each
    ASSERT_GT(some.statistics().in_paths.rays, 0u);
    std::uint64_t in_paths = 0, all = 0;
    for (int attempt = 0; attempt < 5 && in_paths == all; ++attempt) {  // on a busy device all batches are small
        const RenderStatistics before = some.statistics();
        some.restart(0, 4), none.restart(0, 4);
        (void)some.render(), (void)none.render();  // of 1, 1 and 2
        const RenderStatistics after = some.statistics();
        in_paths = after.in_paths.rays - before.in_paths.rays;
        all = after.camera.rays + after.bounce.rays + after.shadow.rays - before.camera.rays - before.bounce.rays -
              before.shadow.rays;
        EXPECT_EQ(some.image(), none.image());
    }
    EXPECT_GT(in_paths, 0u);
    EXPECT_LT(in_paths, all);
}

TEST(WholePaths, AreNotForShortRenders) {
    Renderer renderer(following(99, 100'000, 1'000'000'000), scene_named("effect:sky"), small_config());
    (void)renderer.render();
    EXPECT_EQ(renderer.statistics().in_paths.rays, 0u);
}

TEST(WholePaths, AreNotFollowedThroughInstances) {
    Renderer renderer(following(99, 100'000), scene_named("effect:instances"), small_config());
    (void)renderer.render();
    EXPECT_EQ(renderer.statistics().in_paths.rays, 0u);
}

TEST(WholePaths, GoOnInTheNextFrame) {
    const Scene scene = scene_named("effect:sky");
    Renderer renderer(following(99, 100'000), scene, small_config());
    (void)renderer.render();
    const std::uint64_t before = renderer.statistics().in_paths.rays;
    renderer.restart(7);
    (void)renderer.render();
    EXPECT_GT(renderer.statistics().in_paths.rays, 2 * before);
    RenderConfig other = small_config();
    other.seed = 7;
    Renderer fresh(following(0, 0), scene, other);
    (void)fresh.render();
    EXPECT_EQ(renderer.image(), fresh.image());
}

}  // namespace
}  // namespace claray::test
