// Light maps (render/generate_texels.cl): irradiance against closed forms, and images with a light map against images
// without.
#include "claray/renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/render/bake/texel_points.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

/// A square of side 2 at y = 0 with second texture coordinates.
Scene baked_floor() {
    Scene scene;
    scene.materials = {lambert(0.6f)};
    scene.meshes = {mapped_square()};
    std::swap(scene.meshes[0].uvs, scene.meshes[0].uvs1);
    return scene;
}

glm::dvec3 texel(const Texture& map, unsigned x, unsigned y) {
    const float* at = &map.floats[3 * (std::size_t(y) * map.width + x)];
    return {at[0], at[1], at[2]};
}

TEST(LightMap, HoldsTheIrradianceOfALamp) {
    Scene scene = baked_floor();
    scene.lights = {point_light({0.3f, 1.2f, -0.4f}, {5.f, 2.f, 1.f})};
    const Texture map = bake_light_map(device(), scene, 0, {.width = 16, .height = 8, .spp = 4});
    for (unsigned y = 0; y < 8; ++y)
        for (unsigned x = 0; x < 16; ++x) {
            const glm::dvec3 to(0.3 - ((x + 0.5) / 8 - 1), 1.2, -0.4 - ((y + 0.5) / 4 - 1));
            const double irradiance = 1.2 / std::pow(glm::length(to), 3);
            EXPECT_NEAR(texel(map, x, y).x / irradiance, 5, 1e-3);
            EXPECT_NEAR(texel(map, x, y).z / irradiance, 1, 2e-4);
        }
}

/// Irradiance does not depend on the material.
TEST(LightMap, OfAWhiteSkyIsPi) {
    for (const MaterialKind kind : {MaterialKind::lambert, MaterialKind::mirror, MaterialKind::principled}) {
        Scene scene = baked_floor();
        scene.materials = {material(kind, 0.f)};
        scene.materials[0].sheen = glm::vec3(1.f), scene.materials[0].sheen_roughness = 1.f;
        scene.materials[0].clearcoat = 1.f;
        scene.materials[0].emission = glm::vec3(7.f);
        scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
        const Texture map = bake_light_map(device(), scene, 0, {.width = 4, .height = 4, .spp = 64});
        EXPECT_NEAR(texel(map, 1, 2).x, pi, 1e-4);
    }
}

/// A floor and a wall that light each other, under a lamp.
Scene corner_scene() {
    Scene scene = baked_floor();
    Mesh wall = scene.meshes[0];
    wall.materials.assign(2, 1);
    for (glm::vec3& p : wall.positions) p = {p.x, 1.f - p.z, -1.f};
    scene.meshes.push_back(wall);
    scene.materials.push_back(lambert(0.8f));
    scene.materials[1].albedo = {0.8f, 0.2f, 0.2f};
    scene.lights = {point_light({0.2f, 1.5f, 0.3f}, glm::vec3(5.f))};
    scene.sky = {glm::vec3(0.2f), glm::vec3(0.2f)};
    scene.camera = Camera{{0, 1.5f, 3.5f}, {0, 0.6f, -0.5f}, {0, 1, 0}, 40.f};
    return scene;
}

TEST(LightMap, ImageIsTheSameAsWithout) {
    const Scene plain = corner_scene();
    Scene mapped = plain;
    for (const std::size_t mesh : {0u, 1u})
        use_light_map(mapped, mesh,
                      bake_light_map(device(), plain, mesh, {.width = 48, .height = 48, .spp = 64, .seed = 9}));
    const RenderConfig config{.width = 48, .height = 48, .spp = 128, .max_depth = 16};
    const auto a = render_image(plain, config), b = render_image(mapped, config);
    double worst = 0;
    for (unsigned y = 0; y < 48; y += 8)
        for (unsigned x = 0; x < 48; x += 8) {
            glm::dvec3 sum_a(0.0), sum_b(0.0);
            for (unsigned i = 0; i < 64; ++i) {
                const std::size_t at = (y + i / 8) * 48 + x + i % 8;
                sum_a += glm::dvec3(a[at]), sum_b += glm::dvec3(b[at]);
            }
            for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(sum_b[k] / sum_a[k] - 1));
        }
    EXPECT_LT(worst, 0.02);
    EXPECT_NEAR(mean(b).x / mean(a).x, 1, 0.005);
    EXPECT_NEAR(mean(b).y / mean(a).y, 1, 0.005);
}

/// Paths end at a light map, and no light is sampled there.
TEST(LightMap, EndsPathsAndShadowRays) {
    Scene scene = baked_floor();
    scene.lights = {point_light({0, 1, 0}, glm::vec3(1.f))};
    use_light_map(scene, 0, float_texture({1, 1}, [](double, double) { return 2.0; }));
    scene.camera = narrow_camera({0, 1, 1}, {0, 0, 0});
    Renderer renderer(device(), scene, {.width = 4, .height = 4, .spp = 4});
    renderer.render();
    EXPECT_NEAR(mean(renderer.image()).x, 0.6 / pi * 2, 1e-5);
    EXPECT_EQ(renderer.statistics().shadow.rays, 0u);
    EXPECT_EQ(renderer.statistics().bounce.rays, 0u);
}

TEST(LightMap, IsOfTheFrontAlone) {
    Scene scene = baked_floor();
    use_light_map(scene, 0, float_texture({1, 1}, [](double, double) { return 2.0; }));
    for (const float side : {1.f, -1.f}) {
        scene.camera = narrow_camera({0, side, 1}, {0, 0, 0});
        EXPECT_NEAR(mean(render_image(scene, {.width = 2, .height = 2, .spp = 1})).x, side > 0 ? 0.6 / pi * 2 : 0,
                    1e-5);
    }
}

TEST(LightMap, GivesCopiesOfMaterials) {
    Scene scene = corner_scene();
    scene.meshes[1].materials.assign(2, 0);
    use_light_map(scene, 0, float_texture({1, 1}, [](double, double) { return 1.0; }));
    EXPECT_FALSE(scene.materials[scene.meshes[1].materials[0]].light_map.used());
    EXPECT_TRUE(scene.materials[scene.meshes[0].materials[0]].light_map.used());
}

/// Points lie under the texels' centres, or next to them where the mesh ends within a texel.
TEST(TexelPoints, LieUnderTheTexels) {
    Mesh mesh = mapped_square();
    for (glm::vec2& uv : mesh.uvs) uv = 0.25f + 0.5f * uv;
    const TexelPoints found = find_texel_points(mesh, mesh.uvs, 10, 10, 5, "mesh");
    std::size_t inside = 0;
    for (std::size_t i = 0; i < found.texels.size(); ++i) {
        const glm::dvec2 center(found.texels[i] % 10 + 0.5, found.texels[i] / 10 + 0.5);
        ASSERT_TRUE(found.points[i].primitive == 5 || found.points[i].primitive == 6);
        const glm::uvec3 t = mesh.triangles[found.points[i].primitive - 5];
        const double u = double(found.points[i].u), v = double(found.points[i].v);
        const glm::dvec2 at = 10.0 * ((1 - u - v) * glm::dvec2(mesh.uvs[t.x]) + u * glm::dvec2(mesh.uvs[t.y]) +
                                      v * glm::dvec2(mesh.uvs[t.z]));
        const glm::dvec2 nearest = glm::clamp(center, glm::dvec2(2.5), glm::dvec2(7.5));
        EXPECT_NEAR(glm::length(at - nearest), 0, 1e-5);
        inside += nearest == center;
    }
    EXPECT_EQ(inside, 36u);               // centres 2.5 to 7.5
    EXPECT_EQ(found.texels.size(), 36u);  // the next ones are a whole texel away
}

TEST(LightMap, BadInput) {
    const Scene scene = baked_floor();
    const auto bake = [&](Scene with, LightMapConfig config) {
        return [with, config] { (void)bake_light_map(device(), with, 0, config); };
    };
    EXPECT_TRUE(throws_error(ErrorKind::user, "set 0", bake(scene, {.uv_set = 0})));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "0x1", bake(scene, {.width = 0, .height = 1})));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "0 paths", bake(scene, {.spp = 0})));
    EXPECT_TRUE(throws_error(ErrorKind::user, "no mesh 2", [&] { (void)bake_light_map(device(), scene, 2); }));
    Scene outside = scene;
    outside.meshes[0].uvs1[1].x = 1.2f;
    EXPECT_TRUE(throws_error(ErrorKind::user, "are outside 0..1", bake(outside, {})));
    Scene twice = scene;
    twice.meshes[0].triangles[1] = twice.meshes[0].triangles[0];
    EXPECT_TRUE(throws_error(ErrorKind::user, "cover the same texels", bake(twice, {})));
}

}  // namespace
}  // namespace claray::test
