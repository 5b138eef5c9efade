// Fog between surfaces (kernels/render/shade_hit.clh), against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/effects.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

constexpr float density = 0.2f;
constexpr glm::vec3 fog_color{0.5f, 1.f, 2.f};

/// Looks down on a square of the material from 5 units above it.
Scene foggy_scene(const Material& m) {
    Scene scene;
    scene.materials = {m};
    scene.meshes = {square(1.f, 0.f)};
    scene.camera = narrow_camera({0.f, 5.f, 0.001f}, {0, 0, 0});
    scene.sky.fog_color = fog_color, scene.sky.fog_density = density;
    return scene;
}

glm::dvec3 light_seen(const Scene& scene, unsigned depth = 1, unsigned spp = 256) {
    return mean(render_by_own_kernels(scene, {.width = 8, .height = 8, .spp = spp, .max_depth = depth}));
}

double left_after(double distance) { return std::exp(-double(density) * distance); }

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double share) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], share * std::abs(b[k])) << k;
}

Material black_emitter() {
    Material m = emitter(4.f);
    m.albedo = glm::vec3(0.f);
    return m;
}

TEST(Fog, DimsALampAndShowsItsColorBefore) {
    const double left = left_after(5);
    expect_near(light_seen(foggy_scene(black_emitter())), left * 4.0 + (1 - left) * glm::dvec3(fog_color), 1e-4);
}

TEST(Fog, LiesBeforeTheSkyAsDeepAsItSays) {
    Scene scene = foggy_scene(black_emitter());
    scene.camera->target = {0, 10, 0};
    scene.sky.horizon = scene.sky.zenith = glm::vec3(3.f);
    expect_near(light_seen(scene), glm::dvec3(3), 1e-5);
    scene.sky.fog_depth = 4.f;
    expect_near(light_seen(scene), left_after(4) * 3 + (1 - left_after(4)) * glm::dvec3(fog_color), 1e-5);
}

/// Near lights by their distance, far ones by the depth.
TEST(Fog, DimsLightsThatShadowRaysFind) {
    Scene scene = foggy_scene(lambert(0.6f));
    scene.sky.fog_color = glm::vec3(0.f);
    scene.lights = {point_light({0, 2, 0}, glm::vec3(10.f))};
    const double by_point = 0.6 / std::numbers::pi * 10 / 4 * left_after(2) * left_after(5);
    EXPECT_NEAR(light_seen(scene).x, by_point, 1e-3 * by_point);
    scene.lights.assign(64, point_light({0, 2, 0}, glm::vec3(10.f / 64)));
    EXPECT_TRUE(effects_of(scene).contains({Effect::light_lists}));
    EXPECT_NEAR(light_seen(scene).x, by_point, 1e-3 * by_point);
    scene.lights = {point_light({0, 2, 0}, glm::vec3(10.f))};
    scene.lights[0].kind = LightKind::directional, scene.lights[0].direction = {0, -1, 0};
    scene.sky.fog_depth = 3.f;
    const double by_sun = 0.6 / std::numbers::pi * 10 * left_after(3) * left_after(5);
    EXPECT_NEAR(light_seen(scene).x, by_sun, 1e-3 * by_sun);
}

/// Where all is as bright as the fog, nothing is to be seen: all ways of finding light agree.
TEST(Fog, IsNotSeenInAFurnace) {
    for (const bool by_image : {false, true}) {
        Scene scene = foggy_scene(lambert(1.f));
        scene.sky.fog_color = scene.sky.horizon = scene.sky.zenith = glm::vec3(1.f), scene.sky.fog_depth = 2.f;
        if (by_image) scene.environment.images = {float_texture({8, 4}, [](double, double) { return glm::vec3(1.f); })};
        expect_near(light_seen(scene, 8, 4096), glm::dvec3(1), 3e-3);
    }
}

/// Emission and lamps are combined by multiple importance sampling; without fog the light is known from the form
/// factor.
TEST(Fog, DimsLampsByBothWaysOfFindingThem) {
    Scene scene = foggy_scene(lambert(0.5f));
    scene.sky.fog_color = glm::vec3(0.f);
    scene.materials.push_back(black_emitter());
    Mesh lamp = square(0.02f, 3.f);
    std::swap(lamp.triangles[0].y, lamp.triangles[0].z), std::swap(lamp.triangles[1].y, lamp.triangles[1].z);
    for (glm::vec3& p : lamp.positions) p.x += 1.f;
    lamp.materials.assign(2, 1u);
    scene.meshes.push_back(lamp);
    const double distance2 = 10, cosine = 3 / std::sqrt(10.0), area = 0.04 * 0.04;
    const double light = 0.5 / std::numbers::pi * 4 * area * cosine * cosine / distance2;
    const double expected = light * left_after(std::sqrt(distance2)) * left_after(5);
    EXPECT_NEAR(light_seen(scene, 1, 4096).x, expected, 0.01 * expected);
}

TEST(Fog, IsNotInGlass) {
    Scene scene = foggy_scene(black_emitter());
    Material glass = material(MaterialKind::glass, 1.f);
    glass.ior = 1.f;  // bends and reflects nothing
    scene.materials.push_back(glass);
    Mesh below = square(1.f, 1.f, 1);
    for (glm::uvec3& t : below.triangles) std::swap(t.y, t.z);  // its front is outside
    scene.meshes.push_back(below);
    scene.meshes.push_back(square(1.f, 4.f, 1));
    const double left = left_after(2);
    expect_near(light_seen(scene, 8), left * 4.0 + (1 - left) * glm::dvec3(fog_color), 1e-3);
}

TEST(Fog, IsRefusedIfItsDensityIsNegative) {
    Scene scene = foggy_scene(black_emitter());
    scene.sky.fog_density = -1.f;
    EXPECT_TRUE(throws_error(ErrorKind::user, "density of the fog", [&] { validate(scene); }));
}

TEST(Fog, FollowsChangesOfTheSky) {
    Scene scene = foggy_scene(black_emitter());
    const RenderConfig config{.width = 8, .height = 8, .spp = 4, .max_depth = 1};
    Renderer renderer(device(), scene, config);
    renderer.render();
    scene.sky.fog_density = 0.7f;
    renderer.update(scene, {.sky = true});
    renderer.render();
    EXPECT_EQ(renderer.image(), render_image(scene, config));
}

}  // namespace
}  // namespace claray::test
