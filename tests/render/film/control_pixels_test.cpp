// Control pixels in renders (host/render/controls.cpp).
#include <gtest/gtest.h>

#include <cmath>

#include "host/lights/luminance.hpp"
#include "host/render/film/image_error.hpp"
#include "host/render/renderer_state.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

glm::dvec3 mean_of(const FilmPixel& pixel) {
    const ColorSum& sum = pixel.all;
    return glm::dvec3(double(sum.r) + sum.lost_r, double(sum.g) + sum.lost_g, double(sum.b) + sum.lost_b) /
           double(pixel.count);
}

/// That they are as many samples of the same pixels, and independent of the image.
void expect_second_estimates(Renderer& renderer, const std::string& what) {
    const Renderer::State& state = state_of(renderer);
    const std::vector<FilmPixel> film = state.film.sums();
    const std::vector<ControlPixel>& controls = state.error.progress.controls;
    ASSERT_GT(controls.size(), 500u) << what;
    double sum = 0, squares = 0;
    unsigned equal = 0;
    for (const ControlPixel& control : controls) {
        const FilmPixel& pixel = film[control.pixel];
        ASSERT_EQ(control.sums.count + control.sums.dropped, pixel.count + pixel.dropped) << what;
        const double difference = glm::dot(mean_of(control.sums) - mean_of(pixel), glm::dvec3(1));
        sum += difference, squares += difference * difference, equal += difference == 0;
    }
    EXPECT_LT(equal, controls.size() / 2) << what << ": the sky alone is the same";
    EXPECT_LT(std::abs(sum) / std::sqrt(squares), 4) << what << ": standard errors";
}

TEST(ControlPixels, AreSecondEstimatesOfTheirPixels) {
    for (const char* const name : {"cornell", "effects", "spheres"})
        for (const bool adaptive : {false, true}) {
            Renderer renderer(device(), *builtin_scene(name),
                              {.width = 64, .height = 48, .spp = 40, .error = 1e-5, .adaptive = adaptive});
            renderer.render();
            (void)renderer.error_map();
            expect_second_estimates(renderer, std::string(name) + (adaptive ? ", adaptive" : ""));
        }
}

TEST(ControlPixels, ChangeNoBitOfTheImage) {
    const Scene scene = *builtin_scene("spheres");
    RenderConfig config{.width = 64, .height = 48, .spp = 12};
    const auto image = [&] {
        Renderer renderer(device(), scene, config);
        renderer.render();
        if (config.error > 0) (void)renderer.error_map();
        return renderer.image();
    };
    const std::vector<glm::vec3> plain = image();
    config.error = 1e-5;
    EXPECT_EQ(image(), plain);
}

TEST(ErrorMap, HoldsTheTruthInNineteenOfTwentyPixels) {
    const Scene scene = *builtin_scene("crate");
    const RenderConfig config{.width = 64, .height = 64, .spp = 64};
    Renderer truth(device(), scene, {.width = 64, .height = 64, .spp = 4096, .seed = 7});
    truth.render();
    const std::vector<glm::vec3> expected = truth.image();
    Renderer renderer(device(), scene, config);
    renderer.render();
    const std::vector<glm::vec3> image = renderer.image();
    const std::vector<float> widths = renderer.error_map();
    double within = 0;
    for (std::size_t i = 0; i < image.size(); ++i)
        within += std::abs(luminance(image[i]) - luminance(expected[i])) <= double(widths[i]);
    EXPECT_NEAR(within / double(image.size()), 0.95, 0.02);

    const double denoised = image_error(renderer.denoised(DenoiserKind::claray), expected, 64).rmse;
    EXPECT_NEAR(renderer.error_of(renderer.denoised(DenoiserKind::claray)) / denoised, 1, 0.2);
    EXPECT_THROW((void)renderer.error_of(std::vector<glm::vec3>(5)), Error);
    Renderer black(device(), scene, {.width = 16, .height = 16, .spp = 4});
    EXPECT_EQ(black.error_map(), std::vector<float>(256)) << "before the first sample";
}

TEST(ApproximationError, IsTheErrorToTheExactImage) {
    const Scene scene = *builtin_scene("spheres");
    RenderConfig config{.width = 64, .height = 64, .spp = 64};
    Renderer truth(device(), scene, {.width = 64, .height = 64, .spp = 4096, .seed = 7});
    truth.render();
    config.approximate.no_shadows = true;
    Renderer approximate(device(), scene, config);
    approximate.render();
    config.approximate = {};
    Renderer exact(device(), scene, config);
    const double error = image_error(approximate.image(), truth.image(), 64).rmse;
    EXPECT_GT(error, 0.05) << "shadows are missing";
    EXPECT_NEAR(approximation_error(approximate, exact) / error, 1, 0.1);
    config.width = 32;
    Renderer other(device(), scene, config);
    EXPECT_THROW((void)approximation_error(approximate, other), Error);
}

}  // namespace
}  // namespace claray::test
