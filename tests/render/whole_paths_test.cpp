// The kernel that follows whole paths makes the stages' image, bit for bit, and only where that was asked for.
#include <gtest/gtest.h>

#include <array>

#include "claray/effects.hpp"
#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// A device whose renders follow whole paths in scenes of at most so many effects, and so many surfaces a path.
Device following(unsigned most_effects, unsigned most_bounces_permille, unsigned patience = 0) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.set_tuning("render/trace_paths", "MOST_EFFECTS", most_effects);
    fresh.set_tuning("render/trace_paths", "MOST_BOUNCES_PERMILLE", most_bounces_permille);
    fresh.set_tuning("render/trace_paths", "PATIENCE_MILLISECONDS", patience);
    return fresh;
}

RenderConfig small() {
    RenderConfig config{.width = 24, .height = 20, .spp = 4, .max_depth = 4};
    config.bvh.layout = Layout::binary;
    return config;
}

Scene scene_named(const std::string& name) { return builtin_scene(name).value(); }

void expect_same(const Scene& scene, const std::string& name) {
    const Device whole = following(99, 100'000), staged = following(0, 0);
    Renderer one(whole, scene, small()), many(staged, scene, small());
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
    for (const char* name : {"cornell", "effect:glass", "effect:sky"}) expect_same(scene_named(name), name);
}

TEST(WholePaths, AreAsLongAsThoseOfTheStages) {
    const Scene scene = scene_named("cornell");
    const auto rays_of = [&](unsigned most_effects, unsigned depth) {
        RenderConfig config = small();
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
        expect_same(scene_named(name), name);
}

TEST(WholePaths, HeedMacrosOfShading) {
    const Scene scene = scene_named("cornell");
    const auto image_by = [&](unsigned most_effects, unsigned techniques) {
        const Device fresh = following(most_effects, 100'000);
        fresh.set_tuning("render/shade_surface", "TECHNIQUES", techniques);
        Renderer renderer(fresh, scene, small());
        (void)renderer.render();
        return renderer.image();
    };
    EXPECT_EQ(image_by(99, 1), image_by(0, 1));
    EXPECT_NE(image_by(99, 1), image_by(99, 3));
}

TEST(WholePaths, AreForFewEffectsAndShortPaths) {
    const Scene scene = scene_named("cornell");  // two effects, and nearly two surfaces a path after the first
    const auto follows = [&](unsigned effects, unsigned permille) {
        Renderer renderer(following(effects, permille), scene, small());
        (void)renderer.render();
        return renderer.statistics().in_paths.rays > 0;
    };
    EXPECT_TRUE(follows(2, 3000));
    EXPECT_FALSE(follows(1, 3000));
    EXPECT_FALSE(follows(2, 1000));
}

TEST(WholePaths, AreNotForShortRenders) {
    Renderer renderer(following(99, 100'000, 1'000'000'000), scene_named("effect:sky"), small());
    (void)renderer.render();
    EXPECT_EQ(renderer.statistics().in_paths.rays, 0u);
}

TEST(WholePaths, AreThereBeforeTimeIsCounted) {
    RenderConfig config = small();
    config.seconds = 0.05, config.spp = 1u << 20;
    Renderer renderer(following(99, 100'000, 1'000'000'000), scene_named("effect:sky"), config);
    (void)renderer.render();
    const RenderStatistics statistics = renderer.statistics();
    EXPECT_EQ(statistics.in_paths.rays, statistics.camera.rays + statistics.bounce.rays + statistics.shadow.rays);
}

TEST(WholePaths, AreNotFollowedThroughInstances) {
    Renderer renderer(following(99, 100'000), scene_named("effect:instances"), small());
    (void)renderer.render();
    EXPECT_EQ(renderer.statistics().in_paths.rays, 0u);
}

TEST(WholePaths, GoOnInTheNextFrame) {
    const Scene scene = scene_named("effect:sky");
    Renderer renderer(following(99, 100'000), scene, small());
    (void)renderer.render();
    const std::uint64_t before = renderer.statistics().in_paths.rays;
    renderer.restart(7);
    (void)renderer.render();
    EXPECT_GT(renderer.statistics().in_paths.rays, 2 * before);
    RenderConfig other = small();
    other.seed = 7;
    Renderer fresh(following(0, 0), scene, other);
    (void)fresh.render();
    EXPECT_EQ(renderer.image(), fresh.image());
}

}  // namespace
}  // namespace claray::test
