// Renders of a part of an image: the bits of the whole image.
#include <gtest/gtest.h>

#include "claray/scale/render_group.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

constexpr Region part{7, 5, 20, 11};

template <class Pixel>
std::vector<Pixel> cropped(const std::vector<Pixel>& image, const RenderConfig& whole, const Region& region) {
    std::vector<Pixel> result;
    for (unsigned y = region.y; y < region.y + region.height; ++y)
        for (unsigned x = region.x; x < region.x + region.width; ++x) result.push_back(image[y * whole.width + x]);
    return result;
}

RenderConfig small() { return {.width = 48, .height = 32, .spp = 20}; }

RenderConfig with_region(RenderConfig config, const Region& region = part) {
    config.region = region;
    return config;
}

TEST(Regions, HaveTheBitsOfTheWholeImage) {
    for (const char* name : {"cornell", "spheres", "effect:depth-of-field", "effect:instances", "effect:primitives"}) {
        const Scene scene = *builtin_scene(name);
        Renderer whole(device(), scene, small());
        whole.render();
        for (const Region& region : {part, Region{0, 0, 48, 32}, Region{47, 31, 1, 1}, Region{0, 9, 48, 2}}) {
            Renderer renderer(device(), scene, with_region(small(), region));
            renderer.render();
            EXPECT_TRUE(same_bits(renderer.image(), cropped(whole.image(), small(), region))) << name;
        }
    }
}

/// Guided paths learn from the whole image.
TEST(Regions, AreGuidedAsTheWholeImage) {
    if (device().info().type != DeviceType::cpu) GTEST_SKIP() << "paths are guided on CPUs only";
    const ScopedTuning gain("render/path_guide", "LEAST_GAIN_PERCENT", 1);
    const RenderConfig config{.width = 160, .height = 112, .spp = 20};
    const Scene scene = *builtin_scene("cornell");
    Renderer whole(device(), scene, config);
    whole.render();
    ASSERT_TRUE(whole.statistics().guided);
    const Region region{50, 40, 31, 17};
    Renderer renderer(device(), scene, with_region(config, region));
    renderer.render();
    EXPECT_TRUE(renderer.statistics().guided);
    EXPECT_TRUE(same_bits(renderer.image(), cropped(whole.image(), config, region)));
}

TEST(Regions, HaveTheAovsAndTheAlphaOfTheWholeImage) {
    const Scene scene = *builtin_scene("spheres");
    RenderConfig config = small();
    config.alpha = true;
    Renderer whole(device(), scene, config), renderer(device(), scene, with_region(config));
    whole.render(), renderer.render();
    EXPECT_EQ(renderer.alpha(), cropped(whole.alpha(), config, part));
    const Aovs all = whole.aovs(), some = renderer.aovs();
    EXPECT_EQ(some.depth, cropped(all.depth, config, part));
    EXPECT_EQ(some.material, cropped(all.material, config, part));
    EXPECT_TRUE(same_bits(some.normal, cropped(all.normal, config, part)));
}

TEST(Regions, ContinueFromTheirCheckpoints) {
    const TemporaryFolder folder;
    const Scene scene = *builtin_scene("cornell");
    Renderer whole(device(), scene, small());
    whole.render();
    RenderConfig config = with_region(small());
    config.checkpoint = folder / "c", config.report_seconds = 0;
    Renderer(device(), scene, config).render([](const RenderProgress& at) { return at.spp < 3; });
    config.resume = config.checkpoint;
    Renderer resumed(device(), scene, config);
    resumed.render();
    EXPECT_TRUE(same_bits(resumed.image(), cropped(whole.image(), small(), part)));
    config.region.x += 1;
    EXPECT_THROW(Renderer(device(), scene, config), Error) << "of another region";
}

TEST(Regions, TellTheirProgressAndTheirError) {
    RenderConfig config = with_region({.width = 480, .height = 320, .spp = 4096}, {200, 150, 24, 24});
    config.error = 0.05;
    Renderer renderer(device(), *builtin_scene("cornell"), config);
    const RenderProgress progress = renderer.render();
    EXPECT_LE(progress.error_bound, 0.05);
    EXPECT_GT(progress.error_bound, 0);
    EXPECT_EQ(renderer.error_map().size(), 24u * 24);
    EXPECT_EQ(renderer.noise_map().size(), 24u * 24);
    EXPECT_EQ(renderer.picture().size(), 4u * 24 * 24);
}

TEST(Regions, RefuseWhatNeedsTheWholeImage) {
    const Scene scene = *builtin_scene("cornell");
    const auto refused = [&](const RenderConfig& config) { EXPECT_THROW(Renderer(device(), scene, config), Error); };
    for (const Region& region : {Region{0, 0, 49, 1}, Region{47, 0, 2, 1}, Region{0, 32, 1, 1}, Region{0, 0, 1, 0}})
        refused(with_region(small(), region));
    RenderConfig config = with_region(small());
    config.adaptive = true, refused(config);
    config.adaptive = false, config.approximate.tile_sum = true, refused(config);
    EXPECT_THROW(RenderGroup({device(), device()}, scene, with_region(small())), Error);
    Renderer renderer(device(), scene, with_region(small()));
    EXPECT_THROW(renderer.resize(10, 10), Error);
    EXPECT_THROW(static_cast<void>(renderer.denoised()), Error);
    EXPECT_THROW(static_cast<void>(renderer.gbuffer()), Error);
}

}  // namespace
}  // namespace claray::test
