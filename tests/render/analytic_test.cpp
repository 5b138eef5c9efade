// Images whose radiance is known in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/bsdf/energy_tables.hpp"
#include "host/render/renderer_state.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

Mesh smooth_sphere(int levels) {
    Mesh mesh = sphere(levels);
    mesh.normals = mesh.positions;
    return mesh;
}

// ---- white furnace: a surface that absorbs nothing is invisible before a sky of radiance 1
// -----------------------------

struct Furnace {
    const char* name;
    MaterialKind kind;
    bool smooth;
};

class WhiteFurnace : public testing::TestWithParam<Furnace> {};

TEST_P(WhiteFurnace, SphereIsInvisible) {
    Scene scene;
    scene.materials = {material(GetParam().kind, 1.f)};
    scene.meshes = {GetParam().smooth ? smooth_sphere(4) : sphere(3)};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.camera = Camera{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 38.f};  // the sphere just fits
    // Flat triangles of glass keep light inside: 0.50 % beyond 64 surfaces, 0.24 % beyond 128.
    const glm::dvec3 radiance = mean(render_image(scene, {.width = 48, .height = 48, .spp = 128, .max_depth = 128}));
    EXPECT_NEAR(radiance.x, 1, 0.005);
    EXPECT_NEAR(radiance.y, 1, 0.005);
    EXPECT_NEAR(radiance.z, 1, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Materials, WhiteFurnace,
                         testing::Values(Furnace{"Lambert", MaterialKind::lambert, false},
                                         Furnace{"Mirror", MaterialKind::mirror, false},
                                         Furnace{"Glass", MaterialKind::glass, false},
                                         Furnace{"SmoothLambert", MaterialKind::lambert, true},
                                         Furnace{"SmoothMirror", MaterialKind::mirror, true},
                                         Furnace{"SmoothGlass", MaterialKind::glass, true}),
                         [](const auto& f) { return f.param.name; });

TEST(Ggx, TableOfLostLightIsWhatOneReflectionLacks) {
    const Material metal = material(MaterialKind::metal, 1.f, 0.5f);
    const EnergyTables tables(std::span(&metal, 1));
    for (const int row : {16, 24, 31})
        for (const int node : {14, 24, 31}) {
            const double n = CLARAY_ENERGY_SIZE - 1, alpha = row / n * (row / n);
            const double s = std::pow(std::cos(node / n * pi / 2), 2), cosine = alpha * (1 - s) / (s + alpha);
            EXPECT_NEAR(tables.data().at(row * CLARAY_ENERGY_SIZE + node),
                        1 - verify::single_scattering_albedo(alpha, cosine), 0.004)
                << "roughness " << row / n << ", cosine " << cosine;
        }
}

/// A sky's light coming from triangles all around, by both sampling techniques: their weights must add up to 1.
class LampFurnace : public testing::TestWithParam<float> {};

TEST_P(LampFurnace, LampsAllAroundEqualASky) {
    const bool metal = GetParam() > 0;
    Scene scene = among_lamps(material(metal ? MaterialKind::metal : MaterialKind::lambert, 0.8f, GetParam()));
    const RenderConfig config{.width = 8, .height = 8, .spp = 1024, .max_depth = 1};
    const double lit_by_lamps = mean(render_image(scene, config)).x;
    scene.meshes.pop_back();
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    EXPECT_NEAR(lit_by_lamps / mean(render_image(scene, config)).x, 1, 0.004);
}

INSTANTIATE_TEST_SUITE_P(Roughness, LampFurnace, testing::Values(0.f, 0.2f, 0.5f, 1.f),
                         [](const auto& r) { return "Percent" + std::to_string(int(100 * r.param + 0.5f)); });

// ---- a diffuse sphere lit from its centre (the scene of pbrt's integrator tests)
// ------------------------------------------

/// Albedo 1/2 and intensity pi give 1/2 directly, and each further bounce adds half of the previous light.
TEST(ClosedSphere, EveryBounceAddsHalfOfTheLast) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {sphere(5)};
    scene.lights = {point_light({0, 0, 0}, glm::vec3(float(pi)))};
    scene.camera = Camera{{0, 0, 0.3f}, {0, 0, -1}, {0, 1, 0}, 60.f};
    double area = 0;  // of the polyhedron, over which the lamp's flux is spread
    for (const glm::uvec3& t : scene.meshes[0].triangles) {
        const auto& p = scene.meshes[0].positions;
        area += 0.5 * glm::length(glm::cross(glm::dvec3(p[t.y] - p[t.x]), glm::dvec3(p[t.z] - p[t.x])));
    }
    for (const unsigned depth : {1u, 2u, 3u, 32u}) {
        const double expected = (1 - std::pow(0.5, depth)) * 4 * pi / area;
        const double radiance = mean(render_image(scene, {.width = 32, .height = 32, .spp = 64, .max_depth = depth})).x;
        EXPECT_NEAR(radiance / expected, 1, 0.003) << "depth " << depth;
    }
}

// ---- direct light
// ------------------------------------------------------------------------------------------------------------

TEST(DirectLight, PointLightFollowsInverseSquareAndCosine) {
    for (const double distance : {0.5, 3.0})
        for (const double angle : {0.0, 0.7, 1.4}) {
            Scene scene;
            scene.materials = {lambert(0.6f)};
            scene.meshes = {square(1.f, 0.f)};
            const glm::vec3 towards(std::sin(angle), std::cos(angle), 0);
            scene.lights = {point_light(float(distance) * towards, glm::vec3(5.f))};
            scene.camera = narrow_camera({0, 1, 1}, {0, 0, 0});
            const double expected = 0.6 / pi * 5 * std::cos(angle) / (distance * distance);
            const double radiance = mean(render_image(scene, {.width = 2, .height = 2, .spp = 4, .max_depth = 1})).x;
            EXPECT_NEAR(radiance / expected, 1, 1e-4) << "distance " << distance << ", angle " << angle;
        }
}

/// From a differential element to a parallel rectangle a x b at distance c, above the element by one corner (Howell's
/// catalog of configuration factors, B-3).
double form_factor(double a, double b, double c) {
    const double u = std::hypot(a, c), v = std::hypot(b, c);
    return (a / u * std::atan(b / u) + b / v * std::atan(a / v)) / (2 * pi);
}

TEST(DirectLight, SquareLampEqualsItsFormFactor) {
    for (const double height : {0.05, 0.5, 4.0})
        for (const bool behind : {false, true}) {  // lamps emit on both sides
            Scene scene;
            scene.materials = {lambert(0.6f), emitter(3.f)};
            scene.meshes = {square(6.f, 0.f), square(1.f, float(height), 1)};
            if (behind)
                for (glm::uvec3& t : scene.meshes[1].triangles) std::swap(t.y, t.z);
            scene.camera = narrow_camera({3, 0.02f, 0}, {0.25f, 0, 0.5f});
            double factor = 0;  // of the four rectangles that meet above the point
            for (const double a : {1.25, 0.75})
                for (const double b : {1.5, 0.5}) factor += form_factor(a, b, height);
            const double radiance = mean(render_image(scene, {.width = 8, .height = 8, .spp = 1024, .max_depth = 1})).x;
            EXPECT_NEAR(radiance / (0.6 * 3 * factor), 1, 0.004) << "height " << height << (behind ? ", behind" : "");
        }
}

/// A mirror shows the lamp, the sky and lit surfaces, without light sampling.
TEST(DirectLight, MirrorShowsTheLamp) {
    Scene scene;
    scene.materials = {material(MaterialKind::mirror, 0.9f), emitter(3.f)};
    scene.meshes = {square(1.f, 0.f), square(1.f, 2.f, 1)};
    scene.camera = narrow_camera({0.25f, 1, 0.1f}, {0, 0, 0});
    EXPECT_NEAR(mean(render_image(scene, {.width = 4, .height = 4, .spp = 4, .max_depth = 1})).x, 2.7, 1e-5);
}

// ---- the study of ambient occlusion
// ------------------------------------------------------------------------------------------

/// Of a floor beside a wall: rays whose direction has more than distance / reach of the wall's normal meet it, and
/// these have a segment of the disc that a cosine-weighted hemisphere casts.
double covered_by_wall(double distance, double reach) {
    const double c = std::min(distance / reach, 1.0);
    return (std::acos(c) - c * std::sqrt(1 - c * c)) / pi;
}

/// A device whose kernels of paths, whichever of them a scene uses, are those of the study.
Device device_of_study(unsigned sixteen) {
    Device fresh = Device::open(std::to_string(device().info().index));
    for (const char* kernel : {"render/shade_surface", "render/trace_paths"}) {
        fresh.set_tuning(kernel, "AMBIENT", 1);
        fresh.set_tuning(kernel, "TECHNIQUES", 1);
        fresh.set_tuning(kernel, "SIXTEEN", sixteen);
    }
    return fresh;
}

TEST(AmbientOcclusion, AWallHidesItsSegmentOfTheHemisphereAndReflects) {
    constexpr float reach = 0.5f;
    const RenderConfig config{.width = 8, .height = 8, .spp = 256};
    for (const float distance : {0.05f, 0.2f, 0.4f, 0.6f}) {
        Scene scene;
        scene.materials = {lambert(0.6f), lambert(0.3f)};
        scene.meshes = {square(4.f, 0.f), square(4.f, 0.f, 1)};
        for (glm::vec3& p : scene.meshes[1].positions) p = {-distance, p.x, p.z};
        scene.camera = narrow_camera({0.1f, 3, 0}, {0, 0, 0});
        const auto render = [&](unsigned sixteen) {
            Renderer renderer(device_of_study(sixteen), scene, config);
            state_of(renderer).wavefront.frame.ambient = {3, 0, 0, reach};
            (void)renderer.render();
            return renderer.image();
        };
        const std::vector<glm::vec3> image = render(0);
        const double covered = covered_by_wall(distance, reach);
        EXPECT_NEAR(mean(image).x, 3 * 0.6 * (1 - covered + 0.3 * covered), 1e-3) << distance;
        EXPECT_EQ(mean(image).y, 0) << distance;
        EXPECT_TRUE(same_bits(render(1), image)) << distance;
    }
}

/// Smooth surfaces look as before, and lamps are sampled as before.
TEST(AmbientOcclusion, LeavesDirectLightAndMirrorsAsTheyAre) {
    for (const MaterialKind kind : {MaterialKind::lambert, MaterialKind::mirror}) {
        Scene scene;
        scene.materials = {material(kind, 0.6f), emitter(3.f)};
        scene.meshes = {square(6.f, 0.f), square(1.f, 2.f, 1)};
        scene.camera = narrow_camera({0.25f, 1, 0.1f}, {0, 0, 0});
        const RenderConfig config{.width = 8, .height = 8, .spp = 256, .max_depth = 1};
        Renderer renderer(device_of_study(1), scene, config);
        state_of(renderer).wavefront.frame.ambient = {3, 0, 0, 0.1f};
        (void)renderer.render();
        EXPECT_NEAR(mean(renderer.image()).y / mean(render_image(scene, config)).y, 1, 0.01);
    }
}

}  // namespace
}  // namespace claray::test
