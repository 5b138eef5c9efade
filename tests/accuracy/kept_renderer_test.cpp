// host/accuracy/studies/kept_renderer.hpp: renderers that studies keep.
#include "host/accuracy/studies/kept_renderer.hpp"

#include <gtest/gtest.h>

#include "host/accuracy/rehearsal.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/memory.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

const Scene& box() {
    static const Scene scene = *builtin_scene("cornell");
    return scene;
}

constexpr unsigned side = 16, pixels = side * side;
RenderConfig small(unsigned spp) { return {.width = side, .height = side, .spp = spp}; }

TEST(KeptRenderer, ContinuesTheSameImageWithMoreSamples) {
    KeptRenderer kept(device(), box(), small(16), {}, 0);
    const auto camera_rays = [&] { return kept.renderer()->statistics().camera.rays; };
    const Rendered few = kept.render(7, 3);
    const std::uint64_t before = camera_rays();
    const Rendered more = kept.render(7, 8);
    EXPECT_EQ(camera_rays() - before, 5 * pixels) << "the first three samples are not traced again";
    EXPECT_GT(more.seconds, few.seconds) << "though they count";
    const Rendered again = kept.render(7, 8);
    EXPECT_EQ(camera_rays() - before, 13 * pixels);
    EXPECT_EQ(again.image, more.image);
    (void)kept.render(8, 16);
    (void)kept.render(8, 4);
    EXPECT_EQ(camera_rays() - before, 33 * pixels) << "another seed, and fewer samples";
    EXPECT_NE(kept.render(8, 8, 2).image, kept.render(8, 16).image) << "another depth is another image";
}

/// The parts of a short render take longer than the whole.
TEST(KeptRenderer, BeginsShortRendersAnew) {
    KeptRenderer kept(device(), box(), small(16), {}, 1e9);
    (void)kept.render(7, 3);
    const std::uint64_t before = kept.renderer()->statistics().camera.rays;
    (void)kept.render(7, 8);
    EXPECT_EQ(kept.renderer()->statistics().camera.rays - before, 8 * pixels);
}

TEST(KeptRenderer, MakesRoundsOfAdaptiveSamplingAnew) {
    RenderConfig config = small(64);
    config.adaptive = true;
    KeptRenderer kept(device(), box(), config), other(device(), box(), config);
    (void)kept.render(3, 32);
    EXPECT_EQ(kept.render(3, 64).image, other.render(3, 64).image);
}

TEST(KeptRenderer, IsDroppedIfAnotherNeedsItsMemory) {
    const Device own = Device::open(std::to_string(device().info().index));
    KeptRenderer first(own, box(), small(4)), second(own, box(), small(4));
    const Rendered before = first.render(1, 2);
    (void)second.render(1, 2);
    EXPECT_NE(first.renderer(), nullptr) << "memory for both";
    const std::uint64_t both = bytes_in_use(own);
    // Memory m for one and a half of them beside a third one: 3/4 m = 3/4 both + ample + m / 16.
    state_of(own).info.memory = (both / 4 * 3 + ample_bytes_of(box())) * 16 / 11;
    KeptRenderer third(own, box(), small(4));
    (void)third.render(1, 2);
    EXPECT_EQ(first.renderer(), nullptr) << "used longest ago";
    EXPECT_NE(second.renderer(), nullptr);
    EXPECT_EQ(first.render(1, 4).image, KeptRenderer(own, box(), small(4)).render(1, 4).image);
    EXPECT_EQ(second.renderer(), nullptr);
    EXPECT_EQ(first.render(1, 2).image, before.image);
}

TEST(Rehearsal, HasAsManyThreadsAsItsMemoryAllows) {
    const Device own = Device::open(std::to_string(device().info().index));
    const std::uint64_t one = ample_bytes_of(box());
    EXPECT_EQ(Rehearsal::threads_within_memory(own, box(), 5), 5u);
    for (const auto& [threads, memory] : {std::pair(3u, 10 * one), {2u, 9 * one}}) {  // 5 / 1.625, 4.5 / 1.5625
        state_of(own).info.memory = memory;
        EXPECT_EQ(Rehearsal::threads_within_memory(own, box(), 5), threads);
    }
    state_of(own).info.memory = one;
    EXPECT_EQ(Rehearsal::threads_within_memory(own, box(), 5), 0u);
}

bool held_both = true;

Study study_with_two(const Device& on, const Scene& scene, const StudyOptions&, const AccuracyProgress&) {
    KeptRenderer first(on, scene, small(2)), second(on, scene, small(2));
    (void)first.render(1, 1), (void)second.render(1, 1);
    held_both = first.renderer() != nullptr;
    return {};
}

TEST(Rehearsal, HoldsOneRendererInEachThread) {
    Rehearsal rehearsal(device(), box(), {}, {{"two", study_with_two}}, 1);
    rehearsal.wait();
    EXPECT_FALSE(held_both);
    (void)study_with_two(device(), box(), {}, {});
    EXPECT_TRUE(held_both) << "the study itself has the memory";
}

}  // namespace
}  // namespace claray::test
