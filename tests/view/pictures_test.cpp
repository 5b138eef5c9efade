// What a view shows besides the image: the error map, denoised frames, the frames of an animation.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/seconds_since.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/tuning.hpp"
#include "tests/view/scenes.hpp"

namespace claray::test {
namespace {

using namespace view;

std::vector<std::uint8_t> bytes_of(const Frame& frame) { return {frame.pixels.begin(), frame.pixels.end()}; }

/// The root mean square of the differences, of pixels whose column is from `first` to `last`.
double difference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b, unsigned width,
                  unsigned first, unsigned last) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (i / 4 % width >= first && i / 4 % width <= last && i % 4 != 3)
            sum += std::pow(double(a[i]) - double(b[i]), 2), ++count;
    return std::sqrt(sum / count);
}

Scene rising(double seconds) {
    Scene scene = two_spheres();
    scene.instances[2].transform[3].y += float(seconds);
    return scene;
}

TEST(ViewPlay, PassesAFixedTimePerFrameAndRepeats) {
    const double step = 0.25, length = 0.6;
    ViewConfig config = small_view;
    config.animation = {rising, length, 0, step};
    View view(device(), rising(0), config);
    EXPECT_EQ(run(view, "play"), "plays from 0 s");
    for (int i = 0; i < 2; ++i) EXPECT_FALSE(view.next_frame().complete);
    EXPECT_EQ(bytes_of(view.complete_frame()), rendered(rising(2 * step)));
    (void)view.next_frame();
    run(view, "pause");
    for (int i = 0; i < 2; ++i) EXPECT_TRUE(view.next_frame().complete);
    EXPECT_EQ(run(view, "play"), "stopped at 0.15 s");
    EXPECT_EQ(bytes_of(view.complete_frame()), rendered(rising(std::fmod(3 * step, length))));
    run(view, "time 0.5");
    EXPECT_EQ(run(view, "play"), "plays from 0.5 s");
}

TEST(ViewPlay, PassesTheTimeThatPasses) {
    ViewConfig config = small_view;
    std::vector<double> times;
    config.animation.scene_at = [&](double time) { return times.push_back(time), rising(time); };
    View view(device(), rising(0), config);
    const auto begin = std::chrono::steady_clock::now();
    run(view, "play");
    for (int i = 0; i < 3; ++i) (void)view.next_frame();
    const double passed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    ASSERT_EQ(times.size(), 3u);
    EXPECT_GT(times[0], 0);
    EXPECT_GT(times[2], times[1]);
    EXPECT_GT(times[1], times[0]);
    EXPECT_LT(times[2], passed + 1e-3);
}

TEST(ViewErrorMap, IsTheNoiseOfTheFilm) {
    Renderer renderer(device(), two_spheres(), small_view.render);
    const RenderProgress progress = renderer.render();
    double sum = 0;
    const std::vector<float> map = renderer.noise_map();
    for (const float variance : map) sum += double(variance);
    EXPECT_GT(progress.noise, 0);
    EXPECT_NEAR(std::sqrt(sum / double(map.size())), progress.noise, 1e-4 * progress.noise);
    for (unsigned i = 0; i < 24; ++i) EXPECT_EQ(map[i], 0) << i;  // the sky, which is black
    View view(device(), two_spheres(), small_view);
    run(view, "show error");
    const auto shown = bytes_of(view.complete_frame());
    const Image least = false_color(2, 1, {0, 1});
    for (int k = 0; k < 3; ++k) EXPECT_EQ(shown[k], srgb_from_linear(least.pixels[0][k]));
    unsigned most = 0;
    for (std::size_t i = 0; i < shown.size(); i += 4) {
        bool equal = true;
        for (int k = 0; k < 3; ++k) equal = equal && shown[i + k] == srgb_from_linear(least.pixels[1][k]);
        most += equal;
    }
    EXPECT_GE(most, 1u);
}

/// Noisy, since the light comes from a panel above.
Scene under_a_panel() {
    Scene scene = two_spheres();
    scene.lights.clear();
    scene.materials.resize(3);
    scene.materials[2].emission = glm::vec3(40);
    Mesh panel;
    panel.positions = {{-1, 4, -1}, {1, 4, -1}, {1, 4, 1}, {-1, 4, 1}}, panel.triangles = {{0, 1, 2}, {0, 2, 3}};
    panel.materials = {2, 2};
    scene.meshes.push_back(panel);
    scene.instances.push_back({2});
    return scene;
}

/// Every frame has two samples per pixel.
ViewConfig two_samples() {
    ViewConfig config = small_view;
    config.render.width = 60, config.render.height = 40, config.render.spp = 2;
    config.frame_seconds = 1e9;
    return config;
}

std::vector<std::uint8_t> exact(const Scene& scene) {
    RenderConfig render = two_samples().render;
    render.spp = 512;
    return rendered(scene, render);
}

TEST(ViewDenoise, FramesOfAMovingCameraHaveLessNoise) {
    Warnings none;
    Scene scene = load_scene("cornell", none);
    const auto last_frame = [&](const std::string& how) {
        View view(device(), scene, two_samples());
        run(view, "denoise " + how);
        Frame frame;
        for (int i = 0; i < 8; ++i) run(view, "orbit 0.5 0"), frame = view.next_frame();
        return std::pair(bytes_of(frame), view.camera());
    };
    const auto together = last_frame("on").first;
    const auto [noisy, camera] = last_frame("off");
    scene.camera = camera;
    EXPECT_EQ(noisy, rendered(scene, two_samples().render));
    View single(device(), scene, two_samples());
    run(single, "denoise on");
    const auto alone = bytes_of(single.next_frame()), reference = exact(scene);
    const auto error = [&](const std::vector<std::uint8_t>& bytes) { return difference(bytes, reference, 60, 0, 59); };
    EXPECT_LT(error(alone), 0.5 * error(noisy)) << error(alone) << " against " << error(noisy);
    EXPECT_LT(error(together), 0.85 * error(alone)) << error(together) << " against " << error(alone);
}

TEST(ViewDenoise, AStillFilmIsOneFrame) {
    ViewConfig config = two_samples();
    View view(device(), under_a_panel(), config);
    run(view, "denoise on");
    for (int i = 0; i < 3; ++i) run(view, "orbit 0.5 0"), (void)view.next_frame();
    const auto first = bytes_of(view.next_frame());
    for (int i = 0; i < 3; ++i) EXPECT_EQ(bytes_of(view.next_frame()), first);
    run(view, "denoise off");
    Scene scene = under_a_panel();
    scene.camera = view.camera();
    EXPECT_EQ(bytes_of(view.next_frame()), rendered(scene, config.render));
}

TEST(ViewDenoise, AMovedObjectLeavesNoGhost) {
    View view(device(), under_a_panel(), two_samples());
    run(view, "denoise on");
    for (int i = 0; i < 8; ++i) run(view, "orbit 0.1 0"), (void)view.next_frame();
    const auto before = bytes_of(view.next_frame());
    ASSERT_NE(run(view, "pick 42 20").find("mesh 'ball'"), std::string::npos);
    run(view, "move 0 0 -30");
    Frame frame;
    for (int i = 0; i < 5; ++i) run(view, "orbit 0.001 0"), frame = view.next_frame();
    Scene scene = under_a_panel();
    scene.camera = view.camera(), scene.instances[2].transform[3].z -= 30;
    const auto reference = exact(scene);
    const auto uncovered = [&](const std::vector<std::uint8_t>& bytes) {
        return difference(bytes, reference, 60, 37, 47);
    };
    View still(device(), scene, two_samples());
    run(still, "denoise on");
    const double left = uncovered(bytes_of(frame)), alone = uncovered(bytes_of(still.next_frame()));
    EXPECT_GT(uncovered(before), 8 * left) << left;
    EXPECT_LT(left, alone) << left << " against " << alone;  // of a view that never showed the object
}

/// Of a device that takes `complete` seconds for all pixels and one millisecond for anything.
TEST(ViewPreview, FindsItsSizeAndKeepsIt) {
    for (const double complete : {0.03, 0.2, 0.3}) {
        for (const double first_estimate : {0.03, 0.2, 3.}) {
            view::PreviewSize size(0.05);
            size.complete_took(first_estimate);
            double taken = 0, scale = 0;
            unsigned changes = 0;
            for (unsigned i = 0; i < 20 && size.is_smaller(); ++i) {
                changes += i > 0 && size.scale() != scale;
                scale = size.scale();
                taken = 1e-3 + scale * scale * complete;
                size.preview_took(taken);
            }
            SCOPED_TRACE(std::to_string(complete) + " first taken for " + std::to_string(first_estimate));
            EXPECT_LE(taken, std::max(0.0133, 1e-3 + complete / 16)) << "a quarter of each side is the least";
            EXPECT_TRUE(!size.is_smaller() || taken >= 0.006) << taken << " seconds: smaller than it need be";
            EXPECT_LE(changes, 4u);
        }
    }
    EXPECT_FALSE(view::PreviewSize(0).is_smaller());
    view::PreviewSize grown(0.05);
    grown.complete_took(0.01);
    EXPECT_FALSE(grown.is_smaller());
    grown.complete_grew(16);
    EXPECT_TRUE(grown.is_smaller()) << "a larger image takes longer";
}

/// A view in which every change takes too long.
TEST(ViewPreview, ComesFirstAndLeavesNoTrace) {
    view::ViewConfig config = small_view;
    config.answer_seconds = 1e-9;
    view::View view(device(), two_spheres(), config);
    (void)view.next_frame();  // tells how long a frame takes
    (void)run(view, "orbit 20 0");
    const view::Frame& preview = view.next_frame();
    EXPECT_EQ(preview.width, 24u);
    EXPECT_EQ(preview.spp, 1u);
    EXPECT_FALSE(preview.complete);
    Scene turned = two_spheres();
    turned.camera = view.camera();
    Renderer quarter(device(), turned, {.width = 6, .height = 4, .spp = 1, .max_depth = 4});
    (void)quarter.render();
    const auto enlarged = quarter.picture({.width = 24, .height = 16});
    EXPECT_TRUE(std::equal(enlarged.begin(), enlarged.end(), preview.pixels.begin(), preview.pixels.end()));
    EXPECT_NE(run(view, "pick 12 8"), "") << "in pixels of the complete image";
    const view::Frame& complete = view.complete_frame();
    const std::vector<std::uint8_t> expected = rendered(turned);
    EXPECT_TRUE(complete.complete);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), complete.pixels.begin(), complete.pixels.end()));
    (void)run(view, "orbit 20 0"), (void)view.next_frame();
    (void)run(view, "pause");
    EXPECT_TRUE(view.next_frame().complete);
    (void)run(view, "orbit 1 0");
    EXPECT_EQ(view.next_frame().spp, 1u) << "a paused view shows the first samples of the complete image";
}

}  // namespace
}  // namespace claray::test
