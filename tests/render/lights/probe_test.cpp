// Light at a point (render/bake/probe.cpp): what the probe of an environment, used as an environment, shows.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

constexpr unsigned probe_size = 16;

/// A triangle far below, which hides little of the surroundings.
Scene nearly_empty() {
    Scene scene;
    scene.materials = {lambert(0.f)};
    scene.meshes = {square(1e-3f, -100.f)};
    return scene;
}

/// Smooth, and different in all directions; `x` to the right and `y` down, 0 to 1.
glm::dvec3 radiance_there(double x, double y) {
    const double down = pi * y, across = 2 * pi * (x - 0.5);
    const glm::dvec3 d(std::sin(down) * std::sin(across), std::cos(down), -std::sin(down) * std::cos(across));
    return 1.0 + 0.5 * d + 0.3 * glm::dvec3(d.y * d.z, d.z * d.x, d.x * d.y);
}

TEST(Probe, OfAnEnvironmentIsThatEnvironment) {
    Scene scene = nearly_empty();
    scene.environment.images = {float_texture({4 * probe_size, 2 * probe_size}, radiance_there)};
    scene.environment.strength = 2.f;
    const Environment probe = render_probe(device(), scene, {3, 0, -2}, {.height = probe_size, .spp = 16});
    ASSERT_EQ(probe.images.size(), 6u);
    const Texture panorama = panorama_of(probe);
    ASSERT_EQ(panorama.width, 4 * probe_size);
    ASSERT_EQ(panorama.height, 2 * probe_size);
    double sum = 0;
    for (unsigned i = 0; i < panorama.width * panorama.height; ++i) {
        const glm::dvec3 expected = 2.0 * radiance_there((i % panorama.width + 0.5) / panorama.width,
                                                         (i / panorama.width + 0.5) / panorama.height);
        for (int k = 0; k < 3; ++k) {
            const double error = double(panorama.floats[3 * i + unsigned(k)]) - expected[k];
            EXPECT_NEAR(error, 0, 0.04) << i << ' ' << k;
            sum += error * error;
        }
    }
    EXPECT_LT(std::sqrt(sum / double(panorama.floats.size())), 0.01);
}

/// The six faces light a floor as the sky does of which they were taken.
TEST(Probe, LightsAsItsSurroundings) {
    Scene scene = nearly_empty();
    scene.environment.images = {float_texture({4 * probe_size, 2 * probe_size}, radiance_there)};
    const Environment probe = render_probe(device(), scene, {0, 0, 0}, {.height = probe_size, .spp = 16});
    Scene floor = nearly_empty();
    floor.materials = {lambert(0.5f)}, floor.meshes = {square(1.f, 0.f)};
    for (int direction = 0; direction < 3; ++direction) {
        std::vector<glm::vec3>& corners = floor.meshes[0].positions;
        for (glm::vec3& p : corners) p = {p.y, p.z, p.x};  // the floor faces the next of three directions
        const glm::vec3 n = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
        floor.camera = narrow_camera(3.f * n + glm::vec3(n.y, n.z, n.x), {0, 0, 0});
        const RenderConfig config = {.width = 2, .height = 2, .spp = 1024};
        floor.environment = scene.environment;
        const glm::dvec3 expected = mean(render_image(floor, config));
        floor.environment = probe;
        const glm::dvec3 found = mean(render_image(floor, config));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 0.01 * expected[k]);
    }
}

/// A lamp beside the point is in the middle of the face that looks at it.
TEST(Probe, SeesWhatIsThere) {
    Scene scene;
    scene.materials = {emitter(3.f)};
    scene.meshes = {square(2.f, 0.f)};
    const Environment probe = render_probe(device(), scene, {0, 5, 0}, {.height = probe_size, .spp = 4});
    for (std::size_t face = 0; face < 6; ++face) {
        const double middle = double(probe.images[face].floats[3 * (probe_size / 2 * probe_size + probe_size / 2)]);
        EXPECT_NEAR(middle, face == 3 ? 3 : 0, 1e-5) << face;
    }
}

}  // namespace
}  // namespace claray::test
