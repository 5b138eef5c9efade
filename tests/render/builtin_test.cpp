// Every built-in scene against its mean radiance, from 4096 samples a pixel with another seed. A statistic, not a
// picture: it changes only when a scene or the light transport does.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

struct ExpectedImage {
    const char* scene;
    double red, green, blue;
};
void PrintTo(const ExpectedImage& e, std::ostream* out) { *out << e.scene; }

class BuiltinScene : public testing::TestWithParam<ExpectedImage> {};

TEST_P(BuiltinScene, HasItsMeanRadiance) {
    const ExpectedImage& e = GetParam();
    Renderer renderer(device(), *builtin_scene(e.scene), {.width = 48, .height = 32, .spp = 128});
    const double error_of_mean = renderer.render().noise / std::sqrt(48.0 * 32.0);
    const glm::dvec3 radiance = mean(renderer.image());
    const double tolerance = 4 * error_of_mean + 2e-4;  // the latter for the stored values' own error
    EXPECT_LT(error_of_mean, 0.003);
    EXPECT_NEAR(radiance.x / e.red, 1, tolerance);
    EXPECT_NEAR(radiance.y / e.green, 1, tolerance);
    EXPECT_NEAR(radiance.z / e.blue, 1, tolerance);
    EXPECT_EQ(renderer.statistics().dropped_samples, 0u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BuiltinScene,
                         testing::Values(ExpectedImage{"cornell", 0.130652, 0.084885, 0.024282},
                                         ExpectedImage{"spheres", 0.455819, 0.458411, 0.494647},
                                         ExpectedImage{"crate", 0.329833, 0.289573, 0.258352},
                                         ExpectedImage{"hills", 0.344284, 0.391881, 0.286215},
                                         ExpectedImage{"terrain:1000", 0.380624, 0.420344, 0.377387},
                                         ExpectedImage{"soup:1000", 0.612470, 0.633347, 0.669071},
                                         ExpectedImage{"fan:100", 0.325624, 0.335399, 0.353889}),
                         [](const auto& e) {
                             return std::string(e.param.scene).substr(0, std::string(e.param.scene).find(':'));
                         });

}  // namespace
}  // namespace claray::test
