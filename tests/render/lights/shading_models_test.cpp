// Flat and Gouraud shading and lights without shadows: deferred/sum_lights.cl, render/shade_surface.cl.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using Vec = glm::dvec3;

constexpr double albedo = 0.5, specular = 0.4, shininess = 20;

/// One triangle in z = 0 whose normals lean outwards, and two point lights, seen from above.
Scene shiny_triangle() {
    Scene scene;
    Material shiny = lambert(float(albedo));
    shiny.kind = MaterialKind::blinn_phong, shiny.specular = glm::vec3(float(specular)), shiny.shininess = shininess;
    scene.materials = {shiny};
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1.2f, -0.8f, 0}, {0.1f, 1, 0}};
    for (const glm::vec3& p : mesh.positions)
        mesh.normals.push_back(glm::normalize(glm::vec3(0.4f * p.x, 0.4f * p.y, 1)));
    mesh.triangles = {{0, 1, 2}}, mesh.materials = {0};
    scene.meshes = {mesh};
    for (const glm::vec3& place : {glm::vec3(0.5f, 0.8f, 1.5f), glm::vec3(-1.5f, 0.2f, 2)}) {
        Light light;
        light.position = place, light.intensity = {3, 2, 1};
        scene.lights.push_back(light);
    }
    scene.camera = Camera{{0.2f, -0.4f, 3}, {0.1f, -0.2f, 0}, {0, 1, 0}, 30.f};
    return scene;
}

/// Blinn's model (docs/formats.md) in float64, from its definition.
Vec blinn_phong(const Scene& scene, const Vec& point, const Vec& normal) {
    const Vec viewer = glm::normalize(Vec(scene.camera->position) - point);
    Vec sum(0);
    for (const Light& light : scene.lights) {
        const Vec to_light = Vec(light.position) - point, incoming = glm::normalize(to_light);
        const double cosine = std::max(glm::dot(normal, incoming), 0.0);
        const double half = std::max(glm::dot(normal, glm::normalize(incoming + viewer)), 0.0);
        const double norm =
            (shininess + 2) * (shininess + 4) / (8 * std::numbers::pi * (std::exp2(-shininess / 2) + shininess));
        const double reflected = albedo / std::numbers::pi + specular * norm * std::pow(half, shininess);
        sum += Vec(light.intensity) * (reflected * cosine / glm::dot(to_light, to_light));
    }
    return sum;
}

/// Barycentric coordinates of where the ray through a pixel's centre meets z = 0.
Vec barycentric_of_pixel(const Scene& scene, unsigned x, unsigned y, unsigned side) {
    const CameraData c = camera_data(*scene.camera, 1.f);
    const double u = 2 * (x + 0.5) / side - 1, v = 1 - 2 * (y + 0.5) / side;
    const Vec eye(c.x, c.y, c.z);
    const Vec ray = Vec(c.forward_x, c.forward_y, c.forward_z) + u * Vec(c.right_x, c.right_y, c.right_z) +
                    v * Vec(c.up_x, c.up_y, c.up_z);
    const Vec p = eye - ray * (eye.z / ray.z);
    const Mesh& mesh = scene.meshes[0];
    const Vec a(mesh.positions[0]), e1 = Vec(mesh.positions[1]) - a, e2 = Vec(mesh.positions[2]) - a, d = p - a;
    const double det = e1.x * e2.y - e1.y * e2.x;
    const double s = (d.x * e2.y - d.y * e2.x) / det, t = (e1.x * d.y - e1.y * d.x) / det;
    return {1 - s - t, s, t};
}

RenderConfig summed(unsigned side, const Approximations& model) {
    RenderConfig config{.width = side, .height = side, .spp = 1, .approximate = model};
    config.approximate.tile_sum = true;
    return config;
}

/// A camera so narrow that a pixel's samples and its centre agree.
Scene looking_at(const Vec& target) {
    Scene scene = shiny_triangle();
    scene.camera->target = glm::vec3(target), scene.camera->vertical_fov = 0.01f;
    return scene;
}

Vec position_of(const Scene& scene, const Vec& b) {
    Vec sum(0);
    for (int k = 0; k < 3; ++k) sum += b[k] * Vec(scene.meshes[0].positions[k]);
    return sum;
}

TEST(ShadingModels, GouraudMixesTheColoursOfTheVertices) {
    for (const Vec& b : {Vec(0.2, 0.3, 0.5), Vec(0.7, 0.2, 0.1), Vec(0.05, 0.05, 0.9)}) {
        const Scene scene = looking_at(position_of(shiny_triangle(), b));
        const Vec there = barycentric_of_pixel(scene, 1, 1, 3);
        EXPECT_NEAR(glm::length(there - b), 0, 1e-4);
        Vec expected(0);
        for (int k = 0; k < 3; ++k)
            expected += b[k] * blinn_phong(scene, Vec(scene.meshes[0].positions[k]),
                                           glm::normalize(Vec(scene.meshes[0].normals[k])));
        const Vec seen = mean(render_by_own_kernels(scene, summed(3, {.gouraud = true})));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], expected[k], 1e-3 * expected[k]) << b.x;
        const Vec phong = mean(render_by_own_kernels(scene, summed(3, {})));
        EXPECT_GT(std::abs(phong.x - expected.x), 0.02 * expected.x) << "the case tells nothing";
    }
}

TEST(ShadingModels, FlatIsTheColourOfTheCentroid) {
    const Scene scene = shiny_triangle();
    const Vec expected = blinn_phong(scene, position_of(scene, Vec(1 / 3.)), {0, 0, 1});
    unsigned seen = 0;
    for (const glm::vec3& pixel : render_by_own_kernels(scene, summed(16, {.flat = true}))) {
        if (pixel == glm::vec3(0)) continue;
        ++seen;
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(pixel[k], expected[k], 1e-5 * expected[k]);
    }
    EXPECT_GT(seen, 100u);
}

/// Paths pick one vertex each; nothing here throws shadows or reflects light a second time.
TEST(ShadingModels, PathsHaveTheMeanOfTheSum) {
    const Scene scene = shiny_triangle();
    for (const Approximations& model : {Approximations{.flat = true}, Approximations{.gouraud = true}}) {
        RenderConfig paths{.width = 8, .height = 8, .spp = 1024, .approximate = model};
        RenderConfig sums = summed(8, model);
        sums.spp = 64;
        const Vec a = mean(render_by_own_kernels(scene, paths)), b = mean(render_by_own_kernels(scene, sums));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 0.01 * b[k]);
    }
}

/// Without normals at vertices only the distance and the viewer differ between them.
TEST(ShadingModels, VerticesWithoutNormalsTakeTheTriangles) {
    Scene scene = shiny_triangle();
    scene.meshes[0].normals.clear();
    Vec expected(0);
    const Vec b(0.2, 0.3, 0.5);
    for (int k = 0; k < 3; ++k) expected += b[k] * blinn_phong(scene, Vec(scene.meshes[0].positions[k]), {0, 0, 1});
    scene.camera->target = glm::vec3(position_of(scene, b)), scene.camera->vertical_fov = 0.01f;
    const Vec seen = mean(render_by_own_kernels(scene, summed(3, {.gouraud = true})));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], expected[k], 1e-3 * expected[k]);
}

/// A plate between the light and the floor: the floor is as bright as without the plate.
TEST(ShadingModels, LightsShineThroughEverything) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(3.f, 0.f), square(0.5f, 1.f)};
    Light light;
    light.position = {0, 2, 0}, light.intensity = {3, 2, 1};
    scene.lights = {light};
    scene.camera = narrow_camera({2, 0.8f, 0}, {0, 0, 0});
    RenderConfig config{.width = 4, .height = 4, .spp = 64, .max_depth = 1};
    EXPECT_EQ(mean(render_by_own_kernels(scene, config)), Vec(0)) << "the point is in the shadow";
    config.approximate.no_shadows = true;
    const Vec seen = mean(render_by_own_kernels(scene, config));
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(seen[k], light.intensity[k] * 0.5 / (4 * std::numbers::pi), 1e-4 * light.intensity[k]);
}

TEST(Approximations, AreForScenesThatHaveAUseForThem) {
    const auto names = [](const Scene& scene, const Approximations& among = all_approximations()) {
        std::string all;
        for (const Approximations& one : approximations_for(scene, among)) all += to_string(one) + ' ';
        return all;
    };
    Scene scene;
    scene.materials = {material(MaterialKind::mirror, 1.f, 0.f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.sky = {};
    EXPECT_EQ(names(scene), "flat gouraud ");
    scene.materials = {lambert(0.5f)};
    EXPECT_EQ(names(scene), "light-grid flat gouraud ");
    scene.lights = {Light()};
    EXPECT_EQ(names(scene), "tile-sum light-grid flat gouraud no-shadows ");
    EXPECT_EQ(names(scene, {.tile_sum = true, .flat = true}), "tile-sum flat ");
    EXPECT_EQ(names(scene, {}), "");
}

TEST(ShadingModels, ExcludeEachOther) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "flat and gouraud", [] {
        (void)render_by_own_kernels(shiny_triangle(), summed(3, {.flat = true, .gouraud = true}));
    }));
}

}  // namespace
}  // namespace claray::test
