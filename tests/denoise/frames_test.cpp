// Denoising of frames while the camera moves: denoise/reproject.cl. The scene is a wall with a pattern of light and an
// object before it, computed by hand; the camera is that of the renderer.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/glm.hpp>

#include "claray/scene.hpp"
#include "host/denoise/denoiser.hpp"
#include "tests/denoise/films.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

constexpr std::uint32_t columns = 61, rows = 47;
constexpr float wall_distance = 5, object_distance = 3;

struct Frame {
    CameraData camera;
    std::vector<FilmPixel> film;
    std::vector<Guide> guides;
    std::vector<double> exact;
};

/// The light at a point of the wall; the object, if there is one, is a square around (0, 0) in its own plane.
struct Stage {
    float camera_x = 0;
    bool object = false, shadow = false;
};

double light_of_wall(float x, float y, const Stage& stage) {
    const bool dark = stage.shadow && std::abs(x) < 1 && std::abs(y) < 1;
    return (dark ? 0.3 : 1.0) * (1 + 0.5 * std::sin(double(x)));
}

Frame frame_of(const Stage& stage, std::uint64_t seed) {
    Camera camera;
    camera.position = {stage.camera_x, 0, wall_distance}, camera.target = {stage.camera_x, 0, 0};
    Frame frame;
    frame.camera = camera_data(camera, float(columns) / float(rows));
    Random random(seed);
    for (std::uint32_t i = 0; i < columns * rows; ++i) {
        const float x = 2 * (float(i % columns) + 0.5f) / columns - 1, y = 1 - 2 * (float(i / columns) + 0.5f) / rows;
        const glm::vec3 direction(x * frame.camera.right_x, y * frame.camera.up_y, -1);
        const glm::vec2 on_object = glm::vec2(stage.camera_x, 0) + object_distance * glm::vec2(direction);
        const bool hits = stage.object && std::abs(on_object.x) < 0.6f && std::abs(on_object.y) < 0.6f;
        const float away = (hits ? object_distance : wall_distance);
        const glm::vec2 point = glm::vec2(stage.camera_x, 0) + away * glm::vec2(direction);
        const double light = hits ? 4 : light_of_wall(point.x, point.y, stage);
        PixelSamples samples;
        for (int s = 0; s < 2; ++s) samples.add(glm::dvec3(0.5 * light * 2 * double(random.uniform())));
        frame.film.push_back(samples.pixel());
        frame.guides.push_back(flat_guide(0.5f, 0, 1 / (away * glm::length(direction))));
        frame.exact.push_back(0.5 * light);
    }
    return frame;
}

/// Old light that rises by 1 per pixel to the right is found where a float64 camera sees the point, except before
/// another surface: in the left third of the old frame.
TEST(Reproject, FindsThePointOfTheSameSurface) {
    const Frame now = frame_of({.camera_x = 0.3f}, 1), before = frame_of({}, 2);
    const std::size_t pixels = columns * rows;
    std::vector<Float4> surfaces(pixels), old_surfaces(pixels), old_light(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        surfaces[i] = {0, 0, 1, now.guides[i].nearness}, old_surfaces[i] = {0, 0, 1, before.guides[i].nearness};
        if (i % columns < columns / 3) old_surfaces[i].w *= 1.5f;
        old_light[i] = {float(i % columns), 0, 0, 0.1f};
    }
    const Buffer<Float4> result(device(), pixels);
    const Buffer<float> ages(device(), pixels);
    Kernel reproject = load_kernel(device(), "denoise/reproject.cl", "reproject");
    reproject.run({pixels, 64}, FilterStep{columns, rows, 1}, CameraPair{now.camera, before.camera},
                  arg("surfaces", image_on(device(), surfaces)), arg("light", image_on(device(), old_light)),
                  arg("old_surfaces", image_on(device(), old_surfaces)),
                  arg("old_light", image_on(device(), old_light)),
                  arg("old_ages", Buffer<float>(device(), std::vector<float>(pixels, 7))), arg("result", result),
                  arg("ages", ages));
    const std::vector<Float4> found = pixels_of(result);
    const std::vector<float> found_ages = ages.read();
    const double shift = 0.3 / double(wall_distance) / double(now.camera.right_x) * columns / 2;
    for (std::size_t i = 0; i < pixels; ++i) {
        const double x = double(i % columns) + shift, edge = columns / 3;
        if (std::abs(x - edge) < 1.5 || x > columns - 2) continue;  // between two kinds of pixels
        ASSERT_NEAR(found_ages[i], x < edge ? 0 : 7, 1e-4) << i;
        ASSERT_NEAR(found[i].x, x < edge ? 0 : x, 1e-3) << i;
    }
}

class Player {
public:
    void show(const Frame& frame) {
        image_ = denoiser_
                     .denoise(frame.camera, Buffer<FilmPixel>(device(), frame.film),
                              Buffer<Guide>(device(), frame.guides), 2)
                     .read();
    }
    /// Root mean square of the difference over pixels of the rectangle, and its mean.
    [[nodiscard]] double error(const Frame& frame) const {
        double sum = 0;
        for (std::size_t i = 0; i < frame.exact.size(); ++i) sum += std::pow(double(image_[3 * i]) - frame.exact[i], 2);
        return std::sqrt(sum / double(frame.exact.size()));
    }
    [[nodiscard]] double bias_in_center(const Frame& frame) const {
        double sum = 0, count = 0;
        for (std::uint32_t y = rows / 2 - 4; y <= rows / 2 + 4; ++y)
            for (std::uint32_t x = columns / 2 - 4; x <= columns / 2 + 4; ++x, ++count)
                sum += double(image_[3 * (y * columns + x)]) / frame.exact[y * columns + x] - 1;
        return sum / count;
    }

private:
    FrameDenoiser denoiser_{device(), columns, rows};
    std::vector<float> image_;
};

TEST(FrameDenoiser, AMovingCameraKeepsLessNoiseThanOneFrame) {
    Player player;
    double alone = 0, together = 0;
    for (int i = 0; i < 12; ++i) {
        const Frame frame = frame_of({.camera_x = 0.07f * float(i)}, 100 + std::uint64_t(i));
        Player fresh;
        player.show(frame), fresh.show(frame);
        if (i >= 8) alone += fresh.error(frame), together += player.error(frame);
    }
    EXPECT_LT(together, 0.7 * alone) << together / 4 << " against " << alone / 4;
}

TEST(FrameDenoiser, AnObjectThatDisappearsLeavesNoGhost) {
    Player player;
    for (int i = 0; i < 8; ++i) player.show(frame_of({.object = true}, 200 + std::uint64_t(i)));
    Frame last;
    for (int i = 0; i < 5; ++i) last = frame_of({}, 300 + std::uint64_t(i)), player.show(last);
    EXPECT_LT(std::abs(player.bias_in_center(last)), 0.06);  // the object was four times as bright as the wall
}

TEST(FrameDenoiser, AShadowThatDisappearsLeavesNoGhost) {
    Player player;
    for (int i = 0; i < 16; ++i) player.show(frame_of({.shadow = true}, 400 + std::uint64_t(i)));
    Frame last;
    for (int i = 0; i < 5; ++i) last = frame_of({}, 500 + std::uint64_t(i)), player.show(last);
    EXPECT_LT(std::abs(player.bias_in_center(last)), 0.06);  // the shadow took 70 %
}

TEST(FrameDenoiser, ForgetsOnRequest) {
    FrameDenoiser denoiser(device(), columns, rows);
    const Frame before = frame_of({.shadow = true}, 1), after = frame_of({}, 2);
    const auto show = [&](FrameDenoiser& with, const Frame& f) {
        return with.denoise(f.camera, Buffer<FilmPixel>(device(), f.film), Buffer<Guide>(device(), f.guides), 2).read();
    };
    (void)show(denoiser, before);
    denoiser.forget();
    FrameDenoiser fresh(device(), columns, rows);
    EXPECT_EQ(show(denoiser, after), show(fresh, after));
}

}  // namespace
}  // namespace claray::test
