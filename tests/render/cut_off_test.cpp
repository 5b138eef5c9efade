// Paths of any length: the light lost by Russian roulette and by a depth limit.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

/// Within a closed surface that emits 1 - albedo the radiance is 1 everywhere: emission times 1 + albedo + albedo^2 +
/// ...
Scene furnace(float albedo) {
    Scene scene;
    scene.materials = {lambert(albedo)};
    scene.materials[0].emission = glm::vec3(1.f - albedo);
    scene.meshes = {sphere(2)};
    scene.camera = Camera{{0, 0, 0.3f}, {0, 0, -1}, {0, 1, 0}, 60.f};
    return scene;
}

const RenderConfig small{.width = 16, .height = 16, .spp = 256};

TEST(CutOff, DefaultsLeaveNothingOut) {
    Renderer renderer(device(), furnace(0.9f), small);
    const double noise = renderer.render().noise / 16;  // of the mean of 16 x 16 pixels
    EXPECT_NEAR(mean(renderer.image()).x, 1, 4 * noise + 1e-4);
    EXPECT_LT(4 * noise, 0.01) << "else this tells nothing";
    EXPECT_LT(renderer.cut_off(), 1e-3);
}

/// After n surfaces albedo^(n + 1) is missing.
TEST(CutOff, IsEstimatedInAFurnace) {
    RenderConfig config = small;
    for (const unsigned depth : {1u, 4u, 8u}) {
        config.max_depth = depth;
        Renderer renderer(device(), furnace(0.9f), config);
        renderer.render();
        const double missing = std::pow(0.9, depth + 1);
        EXPECT_NEAR(renderer.cut_off() / missing, 1, 0.05) << depth;
        EXPECT_NEAR(mean(renderer.image()).x, 1 - missing, 0.01) << depth;
    }
}

/// Where light falls in another way at every bounce.
TEST(CutOff, IsTheDifferenceToADeepImageInAnyScene) {
    for (const char* name : {"cornell", "spheres"}) {
        const Scene scene = *builtin_scene(name);
        RenderConfig config{.width = 48, .height = 48, .spp = 64, .max_depth = 2};
        Renderer shallow(device(), scene, config);
        shallow.render();
        config.max_depth = default_max_depth;
        const double missing = 1 - mean(shallow.image()).y / mean(render_image(scene, config)).y;
        EXPECT_NEAR(shallow.cut_off() / missing, 1, 0.25) << name << ": " << missing;
    }
}

/// Rays that leave the scene find no more surfaces.
TEST(CutOff, IsNoneUnderTheSky) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 1, 0.1f}, {0, 0, 0}, {0, 1, 0}, 30.f};
    Renderer renderer(device(), scene, {.width = 16, .height = 16, .spp = 1, .max_depth = 1});
    EXPECT_EQ(renderer.cut_off(), 0);
}

/// An error relative to an image that lacks half of its light is no 5 %, however little noise there is.
TEST(CutOff, CountsInTheError) {
    RenderConfig config = small;
    config.error = 0.05, config.spp = 1u << 16, config.max_depth = 4;
    Renderer cut(device(), furnace(0.9f), config);
    EXPECT_TRUE(throws_error(ErrorKind::user, "is missing", [&] { (void)cut.render(); }));
    config.max_depth = 32;  // which leaves out 3 %
    Renderer most(device(), furnace(0.9f), config);
    const RenderProgress reached = most.render();
    EXPECT_NEAR(reached.cut_off, std::pow(0.9, 33), 0.006);
    EXPECT_GE(reached.error, reached.cut_off);
    EXPECT_GE(reached.error_bound, reached.error);
    EXPECT_LE(reached.error_bound, 0.05);
    EXPECT_NEAR(mean(most.image()).x, 1, 0.05);
}

}  // namespace
}  // namespace claray::test
