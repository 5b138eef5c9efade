// Sums of all lights over the lists of tiles: deferred/bound_tiles.cl, deferred/list_lights.cl, deferred/sum_lights.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

const RenderConfig sums = {.width = 75, .height = 70, .spp = 3, .max_depth = 1, .approximate = {.tile_sum = true}};

/// Points, spots, directional lights and suns; those with a position are above the floor and have ranges.
std::vector<Light> many_lights(unsigned count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    std::vector<Light> lights;
    for (unsigned i = 0; i < count; ++i) {
        Light light = point_light({5 * unit(random), 1.2f + unit(random), 5 * unit(random)}, glm::vec3(0.f));
        light.intensity = glm::vec3(1.5f + unit(random), 1.f, 1.1f + unit(random));
        light.direction = {0.6f * unit(random), -1.f, 0.6f * unit(random)};
        light.range = 1.5f + unit(random), light.linear_range = i % 5 == 2;
        light.inner_angle = 0.2f, light.outer_angle = i % 4 == 1 ? 0.2f : 0.8f;
        if (i % 2 == 1) light.kind = LightKind::spot;
        if (i % 16 == 3) light.range = 0.f;
        if (i % 40 == 0) light.kind = LightKind::directional, light.intensity *= 0.01f;
        if (i % 40 == 20)
            light.kind = LightKind::sun, light.intensity *= 0.01f, light.inner_angle = 0, light.outer_angle = 1e-3f;
        lights.push_back(light);
    }
    return lights;
}

/// A floor with balls of other materials, which scatter to the viewer what they get from the lights.
Scene lit_scene(unsigned lights) {
    Scene scene;
    scene.materials = {lambert(0.7f), material(MaterialKind::metal, 0.9f, 0.4f), lambert(0.4f)};
    scene.materials[2].kind = MaterialKind::principled, scene.materials[2].roughness = 0.3f;
    scene.meshes = {square(6.f, 0.f)};
    for (const std::uint32_t of : {0u, 1u, 2u}) {
        Mesh ball = sphere(2);
        ball.normals = ball.positions;
        for (glm::vec3& p : ball.positions) p += glm::vec3(2.5f * float(of) - 2.5f, 1.f, 0.f);
        ball.materials.assign(ball.triangles.size(), of);
        scene.meshes.push_back(ball);
    }
    scene.lights = many_lights(lights);
    scene.camera = Camera{{0, 5, 9}, {0, 0.5f, 0}, {0, 1, 0}, 50.f};
    return scene;
}

/// Lists that cannot hold a light: every pixel sums over all.
std::vector<glm::vec3> image_of_all_lights(const Scene& scene, const RenderConfig& config) {
    const ScopedTuning tiles("deferred/list_lights", "MOST_PER_TILE", 0),
        blocks("deferred/list_lights", "MOST_PER_BLOCK", 0);
    return render_by_own_kernels(scene, config);
}

TEST(TileSum, ListsGiveTheSumOverAllLightsBitForBit) {
    for (const unsigned lights : {1u, 17u, 300u}) {
        const Scene scene = lit_scene(lights);
        const std::vector<glm::vec3> all = image_of_all_lights(scene, sums);
        EXPECT_TRUE(same_bits(render_by_own_kernels(scene, sums), all)) << lights;
        EXPECT_GT(mean(all).x, 1e-4);
    }
}

TEST(TileSum, ListsThatBecomeTooLongChangeNothing) {
    const Scene scene = lit_scene(300);
    const std::vector<glm::vec3> all = image_of_all_lights(scene, sums);
    const ScopedTuning tiles("deferred/list_lights", "MOST_PER_TILE", 12);
    for (const unsigned most : {40u, 300u}) {
        const ScopedTuning blocks("deferred/list_lights", "MOST_PER_BLOCK", most);
        EXPECT_TRUE(same_bits(render_by_own_kernels(scene, sums), all)) << most;
    }
}

/// A group of a GPU adds up its list once per 8,192 lights of a block.
TEST(TileSum, ListsOfThousandsOfLightsGiveTheSumOverAll) {
    Scene scene = lit_scene(9000);
    for (Light& light : scene.lights) light.range *= 0.2f;
    RenderConfig small = sums;
    small.width = 24, small.height = 18, small.spp = 1;
    EXPECT_TRUE(same_bits(render_by_own_kernels(scene, small), image_of_all_lights(scene, small)));
}

TEST(TileSum, BatchesOfAnySizeMakeTheSameImage) {
    const Scene scene = lit_scene(100);
    const std::vector<glm::vec3> whole = render_by_own_kernels(scene, sums);
    const ScopedTuning paths("render/wavefront", "PATHS", 1024), first("render/wavefront", "FIRST_PATHS", 1024);
    EXPECT_TRUE(same_bits(render_by_own_kernels(scene, sums), whole));
}

/// The light that a white Lambertian floor reflects at a point, by the formulas of KHR_lights_punctual, in float64.
glm::dvec3 reflected_at(const glm::dvec3& point, const std::vector<Light>& lights) {
    glm::dvec3 sum(0);
    for (const Light& light : lights) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction));
        const glm::dvec3 towards = glm::dvec3(light.position) - point;
        double irradiance = 1;
        glm::dvec3 direction = -axis;
        if (light.kind == LightKind::point || light.kind == LightKind::spot) {
            const double d = glm::length(towards);
            direction = towards / d;
            irradiance = 1 / (d * d);
            const double share = light.range > 0 ? d / double(light.range) : 0;
            irradiance *= std::max(1 - (light.linear_range ? share : std::pow(share, 4)), 0.0);
        }
        if (light.kind == LightKind::spot) {
            const double outer = std::cos(double(light.outer_angle)), inner = std::cos(double(light.inner_angle));
            const double share = (glm::dot(axis, -direction) - outer) / std::max(inner - outer, 1e-9);
            irradiance *= std::pow(std::clamp(share, 0.0, 1.0), 2);
        }
        sum += glm::dvec3(light.intensity) * irradiance * std::max(direction.y, 0.0) / pi;
    }
    return sum;
}

TEST(TileSum, IsTheSumOfTheFormulasOfTheLights) {
    Scene scene;
    scene.materials = {lambert(1.f)};
    scene.meshes = {square(6.f, 0.f)};
    scene.lights = many_lights(200);
    for (const glm::vec3& point : {glm::vec3(0, 0, 0), glm::vec3(2.3f, 0, -1.1f), glm::vec3(-3.7f, 0, 0.4f)}) {
        scene.camera = narrow_camera(point + glm::vec3(0.5f, 3, 1), point);
        const glm::dvec3 seen =
            mean(render_by_own_kernels(scene, {.width = 3, .height = 3, .spp = 1, .approximate = {.tile_sum = true}}));
        const glm::dvec3 expected = reflected_at(point, scene.lights);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], expected[k], 2e-3 * expected[k]) << point.x;
    }
}

/// A convex body throws no shadow on itself, and its light does not come back.
TEST(TileSum, IsDirectLightWhereNothingThrowsShadows) {
    Scene scene;
    scene.materials = {lambert(0.8f), material(MaterialKind::metal, 0.8f, 0.4f),
                       material(MaterialKind::principled, 0.5f, 0.4f)};
    scene.meshes = {sphere(3)};
    for (std::uint32_t i = 0; i < scene.meshes[0].triangles.size(); ++i) scene.meshes[0].materials.push_back(i % 3);
    scene.lights = {point_light({2, 1, 2}, glm::vec3(9)), point_light({-3, 0, 1}, glm::vec3(4, 8, 2))};
    scene.lights[1].kind = LightKind::spot, scene.lights[1].direction = {3, 0, -1}, scene.lights[1].range = 8;
    scene.camera = Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 40.f};
    const RenderConfig paths = {.width = 16, .height = 16, .spp = 2048, .max_depth = 1};
    RenderConfig summed = paths;
    summed.approximate.tile_sum = true;
    const glm::dvec3 truth = mean(render_by_own_kernels(scene, paths));
    const glm::dvec3 sum = mean(render_by_own_kernels(scene, summed));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], truth[k], 0.01 * truth[k]);
}

TEST(TileSum, FollowsLightsThatMove) {
    Scene scene = lit_scene(60);
    Renderer renderer(device(), scene, sums);
    (void)renderer.render();
    for (Light& light : scene.lights) light.position += glm::vec3(0.3f, 0.1f, -0.2f);
    scene.lights.resize(50);
    renderer.update(scene, {.lights = true});
    (void)renderer.render();
    EXPECT_TRUE(same_bits(renderer.image(), render_by_own_kernels(scene, sums)));
}

TEST(TileSum, KnowsInstancesAndLenses) {
    Scene scene = lit_scene(100);
    scene.camera->aperture_radius = 0.2f;
    scene.instances = {{0}};
    for (const std::uint32_t mesh : {1u, 2u, 1u, 3u}) {
        glm::mat4 transform(1.f);
        transform[3] = glm::vec4(float(scene.instances.size()) - 2.f, 0.3f, 1.f, 1.f);
        scene.instances.push_back({mesh, transform});
    }
    EXPECT_TRUE(same_bits(render_by_own_kernels(scene, sums), image_of_all_lights(scene, sums)));
}

TEST(TileSum, LeavesScenesWithoutLightsDark) {
    Scene scene = lit_scene(0);
    EXPECT_EQ(mean(render_by_own_kernels(scene, sums)), glm::dvec3(0));
    scene.sky = {glm::vec3(2), glm::vec3(2)};  // is seen, but lights nothing
    scene.camera->target.y = 20;
    EXPECT_NEAR(mean(render_by_own_kernels(scene, sums)).x, 2, 1e-6);
}

TEST(Approximations, AreNamed) {
    EXPECT_EQ(to_string(Approximations{}), "nothing");
    EXPECT_EQ(to_string(parse_approximations("tile-sum")), "tile-sum");
    EXPECT_FALSE(parse_approximations("nothing").any());
    EXPECT_TRUE(throws_error(ErrorKind::usage, "tile-sun", [] { (void)parse_approximations("tile-sun"); }));
}

}  // namespace
}  // namespace claray::test
