// Shading normals that differ from the triangle's: diffuse light uses them unchanged, highlights bent towards the
// viewer.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;
const double tilt = 40 * pi / 180;

Material blinn_phong(float albedo, float highlight) {
    Material m = material(MaterialKind::blinn_phong, albedo);
    m.specular = glm::vec3(highlight), m.shininess = 20.f;
    return m;
}

enum Square {
    mapped_lambert,
    bent_lambert,
    mapped_matt,
    bent_matt,
    shiny,
    plastic,
    smooth_plastic,
    white_lambert,
    bent_shiny,
    matt_plastic,
    squares
};

/// Squares in the plane y = 0, one after the other along z, whose normals lean to +x by 40 degrees: by a normal map, or
/// by those of their vertices. All materials in one scene, so that kernels are compiled once.
Scene leaning() {
    Scene scene;
    scene.materials = {lambert(0.8f),
                       lambert(0.8f),
                       blinn_phong(0.8f, 0.f),
                       blinn_phong(0.8f, 0.f),
                       blinn_phong(0.4f, 0.5f),
                       material(MaterialKind::principled, 1.f, 0.5f),
                       material(MaterialKind::principled, 1.f, 0.f),
                       lambert(1.f),
                       blinn_phong(0.4f, 0.5f),
                       material(MaterialKind::principled, 0.8f, 0.5f)};
    scene.materials[matt_plastic].specular_weight = 0.f;  // only a diffuse lobe, beside one that is resolved
    const glm::vec3 normal(float(std::sin(tilt)), float(std::cos(tilt)), 0.f);
    const glm::vec3 texel = 0.5f + 0.5f * glm::vec3(normal.x, 0.f, normal.y);
    scene.textures = {float_texture({1, 1}, [&](double, double) { return texel; })};
    for (std::uint32_t i = 0; i < squares; ++i) {
        Mesh mesh = mapped_square(i);
        for (glm::vec3& p : mesh.positions) p.z += 3.f * float(i);
        if (i == bent_lambert || i == bent_matt || i == bent_shiny)
            mesh.normals.assign(4, normal);
        else
            scene.materials[i].normal_map.texture = 0;
        scene.meshes.push_back(mesh);
    }
    return scene;
}

/// From the side away from which the normals lean, `elevation` degrees above the plane.
glm::dvec3 view_from(double elevation) { return {-std::cos(elevation * pi / 180), std::sin(elevation * pi / 180), 0}; }

void look_at(Scene& scene, Square square, const glm::dvec3& view) {
    const glm::vec3 at(0.f, 0.f, 3.f * float(square));
    scene.camera = narrow_camera(at + 2.f * glm::vec3(view), at);
}

double seen_square(Scene& scene, Square square, const glm::dvec3& view, const RenderConfig& config) {
    look_at(scene, square, view);
    return mean(render_image(scene, config)).x;
}

Light sun_from(const glm::dvec3& direction, float irradiance) {
    Light sun;
    sun.kind = LightKind::directional, sun.direction = -glm::vec3(direction), sun.intensity = glm::vec3(irradiance);
    return sun;
}

/// Keller et al. 2017, section A.3, in float64.
glm::dvec3 bent(const glm::dvec3& normal, const glm::dvec3& view) {
    const glm::dvec3 mirrored = 2 * glm::dot(normal, view) * normal - view;
    const double least = std::min(0.01, 0.9 * view.y);
    if (mirrored.y >= least) return normal;
    return glm::normalize(view + glm::normalize(mirrored + glm::dvec3(0, least - mirrored.y, 0)));
}

/// The integral of f(i) times the sky's radiance over the hemisphere above the plane.
double integrate(const std::function<double(const glm::dvec3&)>& f, const Sky& sky) {
    const int n = 800;
    double sum = 0;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b) {
            const double y = (a + 0.5) / n, phi = 2 * pi * (b + 0.5) / n, s = std::sqrt(1 - y * y);
            sum += f({s * std::cos(phi), y, s * std::sin(phi)}) * (sky.horizon.x + (sky.zenith.x - sky.horizon.x) * y);
        }
    return sum * 2 * pi / n / n;
}

const glm::dvec3 normal(std::sin(tilt), std::cos(tilt), 0);

/// albedo / pi times the irradiance of the leaning surface, from every view.
TEST(BentNormals, DiffuseLightIsTheSameFromEverywhere) {
    Scene scene = leaning();
    for (const double light : {35.0, 60.0, 120.0}) {  // above the plane, from the viewer's side on
        const glm::dvec3 to_light = view_from(light);
        scene.lights = {sun_from(to_light, 3.f)};
        const double expected = 0.8 / pi * 3 * std::max(0.0, glm::dot(normal, to_light));
        for (const Square square : {mapped_lambert, bent_lambert, mapped_matt, bent_matt, matt_plastic})
            for (const double elevation : {80.0, 60.0, 30.0, 5.0})
                EXPECT_NEAR(seen_square(scene, square, view_from(elevation), {.width = 1, .height = 1, .spp = 1}),
                            expected, 1e-5)
                    << "square " << square << ", light at " << light << ", seen at " << elevation;
    }
}

const RenderConfig under_sky{.width = 8, .height = 8, .spp = 1024, .max_depth = 1};

/// A sky is found by BSDF sampling.
TEST(BentNormals, DiffuseLightAndHighlightUnderASky) {
    Scene scene = leaning();
    scene.sky = {glm::vec3(0.2f), glm::vec3(3.f)};
    for (const double elevation : {70.0, 10.0}) {
        const glm::dvec3 view = view_from(elevation), to = bent(normal, view);
        const double norm = 22.0 * 24 / (8 * pi * (std::pow(2, -10) + 20));
        const auto f = [&](const glm::dvec3& i) {
            const double diffuse = 0.4 / pi * std::max(0.0, glm::dot(normal, i)), z = glm::dot(to, i);
            return diffuse + (z > 0 ? 0.5 * norm * std::pow(glm::dot(to, glm::normalize(view + i)), 20) * z : 0);
        };
        const double expected = integrate(f, scene.sky);
        for (const Square square : {shiny, bent_shiny})
            EXPECT_NEAR(seen_square(scene, square, view, under_sky) / expected, 1, 0.005)
                << square << ", " << elevation;
    }
}

/// Under a white sky a white surface reflects no more light than arrives, and is nowhere black: a leaning Lambertian
/// sees (1 + cos) / 2 of the sky.
TEST(BentNormals, GainNoLightAndLeaveNoFringe) {
    Scene scene = leaning();
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    const double seen_sky = 0.5 * (1 + std::cos(tilt));
    for (const double elevation : {85.0, 40.0, 15.0, 3.0}) {
        EXPECT_NEAR(seen_square(scene, white_lambert, view_from(elevation), under_sky), seen_sky, 0.003) << elevation;
        for (const Square square : {plastic, smooth_plastic}) {
            const double radiance = seen_square(scene, square, view_from(elevation), under_sky);
            EXPECT_LT(radiance, 1.003) << elevation;
            EXPECT_GT(radiance, 0.9 * seen_sky) << elevation;
        }
    }
}

/// A coarse sphere with smooth normals is nowhere brighter than their cosine says. Where its triangles are seen at
/// grazing angles near the terminator, bent normals would see the sun. Pixels on the outline show less.
TEST(BentNormals, NoBrightSliverAtTheTerminator) {
    const glm::dvec3 to_sun = glm::normalize(glm::dvec3(0.3, 1, 0.1));
    const Mesh mesh = sphere(2);
    Scene scene;
    scene.materials = {lambert(1.f)};
    scene.meshes = {mesh};
    scene.meshes[0].normals = mesh.positions;
    scene.lights = {sun_from(to_sun, float(pi))};
    scene.camera = Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 28.f};
    const unsigned size = 300;
    Renderer renderer(device(), scene, {.width = size, .height = size, .spp = 4, .max_depth = 1});
    renderer.render();
    const auto image = renderer.image();
    const auto triangles = renderer.aovs().primitive;
    for (unsigned i = 0; i < size * size; ++i) {
        if (triangles[i] == CLARAY_MISS) continue;
        const double slope = std::tan(14 * pi / 180), x = 2 * (i % size + 0.5) / size - 1,
                     y = 1 - 2 * (i / size + 0.5) / size;
        const glm::dvec3 eye(0, 0, 4), d = glm::normalize(glm::dvec3(x * slope, y * slope, -1));
        const glm::uvec3 t = mesh.triangles[triangles[i]];
        const glm::dvec3 a(mesh.positions[t.x]), e1 = glm::dvec3(mesh.positions[t.y]) - a,
                                                 e2 = glm::dvec3(mesh.positions[t.z]) - a;
        const glm::dvec3 p = glm::cross(d, e2), q = glm::cross(eye - a, e1);
        const double u = glm::dot(eye - a, p) / glm::dot(e1, p), v = glm::dot(d, q) / glm::dot(e1, p);
        const double cosine = glm::dot(glm::normalize(a + u * e1 + v * e2), to_sun);
        EXPECT_LT(image[i].x, std::max(0.0, cosine) + 0.05) << i % size << ", " << i / size;
    }
}

/// Lights and directions are sampled with densities of both normals: each technique alone gives the same light as both.
TEST(BentNormals, BothTechniquesAgree) {
    Scene scene = leaning();
    scene.environment.images = {float_texture({64, 32}, [](double u, double v) {
        return glm::vec3(float(1 + 0.8 * std::cos(2 * pi * u) * std::sin(pi * v)));
    })};
    double radiance[4][2];
    const double elevations[] = {70, 8};
    for (const std::uint32_t techniques : {1u, 2u, 3u})
        for (int i = 0; i < 2; ++i) {
            look_at(scene, plastic, view_from(elevations[i]));
            radiance[techniques][i] = mean(render_by_techniques(techniques, scene, under_sky)).x;
        }
    for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(radiance[1][i] / radiance[3][i], 1, 0.005) << elevations[i];
        EXPECT_NEAR(radiance[2][i] / radiance[3][i], 1, 0.005) << elevations[i];
    }
}

}  // namespace
}  // namespace claray::test
