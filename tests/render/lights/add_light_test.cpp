// The light of shadow rays: added by render/trace_shadow_rays.cl itself, or afterwards by render/add_light.cl.
#include <gtest/gtest.h>

#include "claray/io.hpp"
#include "claray/profiler.hpp"
#include "claray/renderer.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

struct Outcome {
    std::vector<glm::vec3> pixels;
    std::uint64_t shadow_rays = 0;
    bool stage_ran = false;
};

Outcome outcome_of(const char* scene, Layout layout, bool with_shadow_rays) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.set_tuning("render/add_light", "WITH_SHADOW_RAYS", with_shadow_rays);
    fresh.set_tuning("render/trace_paths", "MOST_EFFECTS", 0);
    RenderConfig config{.width = 24, .height = 20, .spp = 4, .max_depth = 4};
    config.bvh.layout = layout;
    Scene lit = builtin_scene(scene).value();
    lit.lights.push_back(point_light({0.3f, 1.5f, 0.7f}, {2.f, 3.f, 4.f}));
    Renderer renderer(fresh, lit, config);
    (void)renderer.render();
    return {renderer.image(), renderer.statistics().shadow.rays, fresh.profiler().summary().contains("add_light")};
}

void expect_image_of_both(const char* scene, Layout layout, bool added_by_rays) {
    const Outcome with_rays = outcome_of(scene, layout, true), by_stage = outcome_of(scene, layout, false);
    EXPECT_EQ(with_rays.pixels, by_stage.pixels) << scene;
    EXPECT_EQ(with_rays.shadow_rays, by_stage.shadow_rays) << scene;
    EXPECT_GT(by_stage.shadow_rays, 0u) << scene;
    EXPECT_TRUE(by_stage.stage_ran) << scene;
    EXPECT_EQ(with_rays.stage_ran, !added_by_rays) << scene;
}

TEST(AddLight, ShadowRaysDoTheSame) {
    for (const char* scene : {"cornell", "effect:many-lights", "effect:cut-outs"})
        expect_image_of_both(scene, Layout::binary, true);
}

TEST(AddLight, IsAStageForOtherStructures) {
    expect_image_of_both("cornell", Layout::wide, false);
    expect_image_of_both("effect:instances", Layout::binary, false);
}

}  // namespace
}  // namespace claray::test
