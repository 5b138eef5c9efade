// Every kind of light against a closed form: lights/kinds.clh, lights/light_triangle.clh.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/effects/effects.hpp"
#include "host/lights/lights.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;
constexpr float floor_albedo = 0.6f;

Scene floor_scene() {
    Scene scene;
    scene.materials = {lambert(floor_albedo)};
    scene.meshes = {square(20.f, 0.f)};
    return scene;
}

/// Irradiance of the floor at a point, from its radiance.
double irradiance(Scene scene, const glm::vec3& at) {
    scene.camera = narrow_camera(at + glm::vec3(0.3f, 1.f, 1.f), at);
    return mean(render_image(scene, {.width = 2, .height = 2, .spp = 4, .max_depth = 1})).x * pi / floor_albedo;
}

Light make_light(LightKind kind, const glm::vec3& position, const glm::vec3& direction, float intensity) {
    Light light;
    light.kind = kind, light.position = position, light.direction = direction, light.intensity = glm::vec3(intensity);
    return light;
}

TEST(DirectionalLight, FollowsTheCosine) {
    for (const double angle : {0.0, 0.8, 1.5}) {
        Scene scene = floor_scene();
        const glm::vec3 direction(7 * std::sin(angle), -7 * std::cos(angle), 0);  // of any length
        scene.lights = {make_light(LightKind::directional, {}, direction, 3.f)};
        EXPECT_NEAR(irradiance(scene, {1, 0, 2}) / (3 * std::cos(angle)), 1, 1e-4) << angle;
    }
    Scene scene = floor_scene();
    scene.lights = {make_light(LightKind::directional, {}, {0, 1, 0.1f}, 3.f)};  // from below
    EXPECT_EQ(irradiance(scene, {1, 0, 2}), 0);
}

TEST(DirectionalLight, IsShadowedHoweverFarAway) {
    Scene scene = floor_scene();
    scene.meshes.push_back(square(1.f, 1e6f));
    scene.lights = {make_light(LightKind::directional, {}, {0, -1, 0}, 3.f)};
    EXPECT_EQ(irradiance(scene, {0.f, 0, 0}), 0);
    EXPECT_NEAR(irradiance(scene, {2.f, 0, 0}), 3, 1e-3);
}

/// Before, within and behind the edge of the cone, by the formula of KHR_lights_punctual.
TEST(SpotLight, FallsOffBetweenItsCones) {
    const double height = 2, inner = 0.3, outer = 0.5;
    for (const double angle : {0.0, 0.29, 0.35, 0.45, 0.49, 0.51, 1.0}) {
        Scene scene = floor_scene();
        scene.lights = {make_light(LightKind::spot, {0, float(height), 0}, {0, -3, 0}, 5.f)};
        scene.lights[0].inner_angle = float(inner), scene.lights[0].outer_angle = float(outer);
        const double within =
            std::clamp((std::cos(angle) - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.0, 1.0);
        const double distance = height / std::cos(angle);
        const double expected = 5 * within * within * std::cos(angle) / (distance * distance);
        EXPECT_NEAR(irradiance(scene, {float(height * std::tan(angle)), 0, 0}), expected,
                    2e-4 * 5 / 4 + 1e-3 * expected)
            << angle;
    }
}

/// An edge of 0.01 degree is as narrow as it is given.
TEST(SpotLight, KeepsANarrowEdge) {
    const double degree = pi / 180, outer = 45 * degree, inner = 44.99 * degree;
    Scene scene = floor_scene();
    scene.meshes = {square(1.5f, 0.f)};  // whose points are known to 1e-6, a hundredth of the edge
    scene.lights = {make_light(LightKind::spot, {0, 1, 0}, {0, -1, 0}, 5.f)};
    scene.lights[0].inner_angle = float(inner), scene.lights[0].outer_angle = float(outer);
    for (const double angle : {44.98, 44.9925, 44.995, 44.9975, 45.01}) {
        const glm::vec3 at(float(std::tan(angle * degree)), 0.f, 0.f);
        scene.camera = narrow_camera(at + glm::vec3(0.f, 0.01f, 0.f), at);  // sees 2e-6 of the floor
        const double c = std::cos(double(float(angle * degree))), o = std::cos(double(float(outer)));
        const double within = std::clamp((c - o) / (std::cos(double(float(inner))) - o), 0.0, 1.0);
        const double radiance =
            mean(render_image(scene, {.width = 1, .height = 1, .spp = 1, .max_depth = 1})).x * pi / floor_albedo;
        EXPECT_NEAR(radiance, 5 * within * within * std::pow(c, 3), 0.02) << angle;
    }
}

TEST(SpotLight, ShinesAlongItsAxis) {
    Scene scene = floor_scene();
    scene.lights = {make_light(LightKind::spot, {3, 2, 0}, {-3, -2, 0}, 5.f)};
    scene.lights[0].inner_angle = 0.05f, scene.lights[0].outer_angle = 0.1f;
    EXPECT_NEAR(irradiance(scene, {0, 0, 0}), 5 * (2 / std::sqrt(13.0)) / 13, 1e-4);
    EXPECT_EQ(irradiance(scene, {3, 0, 0}), 0);
}

TEST(LightRange, FadesToNothing) {
    for (const double distance : {0.5, 1.9, 2.9, 3.1}) {
        Scene scene = floor_scene();
        scene.lights = {point_light({0, float(distance), 0}, glm::vec3(5.f))};
        scene.lights[0].range = 3.f;
        const double expected = 5 * std::max(1 - std::pow(distance / 3, 4), 0.0) / (distance * distance);
        EXPECT_NEAR(irradiance(scene, {0, 0, 0}), expected, 2e-4 * expected) << distance;
    }
}

TEST(LightRange, EndsLinearly) {
    for (const double distance : {0.5, 1.9, 2.5, 3.1})
        for (const LightKind kind : {LightKind::point, LightKind::spot}) {
            Scene scene = floor_scene();
            scene.lights = {point_light({0, float(distance), 0}, glm::vec3(5.f))};
            scene.lights[0].kind = kind, scene.lights[0].range = 3.f;
            scene.lights[0].linear_range = true, scene.lights[0].attenuation = {1, 0, 0};
            const double expected = 5 * std::max(1 - distance / 3, 0.0);
            EXPECT_NEAR(irradiance(scene, {0, 0, 0}), expected, 2e-4 * expected) << distance;
            scene.lights[0].attenuation = {0, 0, 1};
            EXPECT_NEAR(irradiance(scene, {0, 0, 0}) * distance * distance, expected, 2e-4 * expected) << distance;
        }
}

TEST(LightAttenuation, IsAPolynomialOfTheDistance) {
    for (const glm::vec3 a : {glm::vec3(1, 0, 0), glm::vec3(0, 2, 0), glm::vec3(0.5f, 0.25f, 2), glm::vec3(0, 0, 4)})
        for (const double distance : {0.25, 3.0}) {
            Scene scene = floor_scene();
            scene.lights = {point_light({0, float(distance), 0}, glm::vec3(5.f))};
            scene.lights[0].attenuation = a;
            const double expected = 5 / (a.x + a.y * distance + a.z * distance * distance);
            EXPECT_NEAR(irradiance(scene, {0, 0, 0}), expected, 2e-4 * expected)
                << a.x << a.y << a.z << " " << distance;
        }
}

Light sun(const glm::vec3& direction, float angle, float irradiance) {
    Light light = make_light(LightKind::sun, {}, direction, irradiance);
    light.outer_angle = angle;
    return light;
}

/// A mirror shows the disc with its radiance, and nothing beside it.
TEST(SunLight, IsSeenByMirrors) {
    const float angle = 0.02f;
    for (const float off : {0.f, 0.9f, 1.1f}) {
        Scene scene = floor_scene();
        scene.materials = {material(MaterialKind::mirror, 1.f)};
        scene.lights = {sun({-std::sin(0.3f + off * angle), -std::cos(0.3f + off * angle), 0}, angle, 3.f)};
        scene.camera = narrow_camera({-std::sin(0.3f), std::cos(0.3f), 0}, {0, 0, 0});
        const double radiance = mean(render_image(scene, {.width = 2, .height = 2, .spp = 4})).x;
        EXPECT_NEAR(radiance / (3 / (pi * std::pow(std::sin(angle), 2))), off < 1 ? 1 : 0, 1e-3) << off;
    }
}

/// The edge of a wide plate covers the half of a disc at the zenith: under it a point gets half of the irradiance, and
/// the width of the penumbra is the height of the plate times twice the tangent of the angle.
TEST(SunLight, HasAPenumbra) {
    const float angle = 0.1f, height = 2.f;
    for (const double place : {-1.05, -0.5, 0.0, 0.5, 1.05}) {
        Scene scene = floor_scene();
        scene.meshes.push_back(square(20.f, height));
        for (glm::vec3& p : scene.meshes[1].positions) p.x += 20.f;
        scene.lights = {sun({0, -1, 0}, angle, 3.f)};
        const glm::vec3 at(-float(place) * height * std::tan(angle), 0.f, 0.f);
        scene.camera = narrow_camera(at + glm::vec3(-0.3f, 1.f, 1.f), at);
        const RenderConfig config{.width = 16, .height = 16, .spp = 256, .max_depth = 1};
        // The share of a disc beyond a chord at `place` radii; the disc is small enough to be flat.
        const double p = std::clamp(place, -1.0, 1.0);
        const double share = 1 - (std::acos(p) - p * std::sqrt(1 - p * p)) / pi;
        EXPECT_NEAR(mean(render_image(scene, config)).x * pi / floor_albedo / 3, share, 0.01) << place;
    }
}

/// In the direction of its largest intensity, a surface facing the light gets that intensity, for near lights divided
/// by the squared distance.
TEST(LightKinds, ShineByTheirIntensity) {
    for (const LightTraits& kind : light_kinds) {
        Scene scene = floor_scene();
        scene.lights = {make_light(kind.kind, {0, 2, 0}, {0, -1, 0}, 3.f)};
        if (kind.cone) scene.lights[0].inner_angle = 0.1f, scene.lights[0].outer_angle = 0.2f;
        scene.camera = narrow_camera({0.3f, 1.f, 1.f}, {0, 0, 0});
        const RenderConfig config{.width = 8, .height = 8, .spp = 64, .max_depth = 1};
        EXPECT_NEAR(mean(render_image(scene, config)).x * pi / floor_albedo, kind.far ? 3 : 0.75, 0.002) << kind.name;
    }
}

/// Point, spot, directional and triangle at once: every kind is picked by its own kernel code.
TEST(Lights, OfAllKindsAddUp) {
    Scene scene = floor_scene();
    scene.materials.push_back(emitter(2.f));
    double sum = 0;
    const std::vector<Light> lights = {point_light({1, 2, 0}, glm::vec3(4.f)),
                                       make_light(LightKind::spot, {0, 3, 1}, {0, -3, -1}, 9.f),
                                       make_light(LightKind::directional, {}, {1, -1, 0}, 0.7f)};
    for (const Light& light : lights) {
        scene.lights = {light};
        sum += irradiance(scene, {0, 0, 0});
    }
    scene.lights = {};
    scene.meshes.push_back(square(0.3f, 1.5f, 1));
    scene.camera = narrow_camera({0.3f, 1.f, 1.f}, {0, 0, 0});
    const RenderConfig config{.width = 16, .height = 16, .spp = 256, .max_depth = 1};
    const double lamp = mean(render_image(scene, config)).x * pi / floor_albedo;
    EXPECT_GT(lamp, 0.1);
    scene.lights = lights;
    EXPECT_NEAR(mean(render_image(scene, config)).x * pi / floor_albedo / (sum + lamp), 1, 0.005);
}

/// Irradiance from a polygon of constant radiance, all of it above the horizon (Lambert 1760; Baum et al. 1989,
/// equation 12): half the sum over its edges of the angle they subtend times the cosine of their plane's normal.
double lambert_irradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& from, const glm::dvec3& normal) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::normalize(corners[i] - from),
                         b = glm::normalize(corners[(i + 1) % corners.size()] - from);
        sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), normal);
    }
    return 0.5 * std::abs(sum);
}

/// A single triangle aslant, near and far, from both of its sides.
TEST(TriangleLight, EqualsLambertsFormula) {
    const std::vector<std::vector<glm::dvec3>> triangles = {
        {{-0.5, 0.3, 0.2}, {0.6, 0.9, -0.4}, {0.1, 0.5, 0.8}},
        {{2, 0.1, 1}, {3, 2, 0}, {2.5, 1, -1}},
        {{-30, 20, 0}, {-10, 50, 9}, {10, 20, 33}},
    };
    for (const auto& corners : triangles)
        for (const bool turned : {false, true}) {
            Scene scene = floor_scene();
            scene.materials.push_back(emitter(3.f));
            Mesh mesh;
            for (const glm::dvec3& corner : corners) mesh.positions.emplace_back(corner);
            mesh.triangles = {turned ? glm::uvec3(0, 2, 1) : glm::uvec3(0, 1, 2)};
            mesh.materials = {1};
            scene.meshes.push_back(mesh);
            scene.camera = narrow_camera({-0.05f, 0.1f, -0.1f}, {0, 0, 0});
            Renderer renderer(device(), scene, {.width = 16, .height = 16, .spp = 512, .max_depth = 1});
            const double error_of_mean = renderer.render().noise / 16;
            const double expected = floor_albedo / pi * 3 * lambert_irradiance(corners, {0, 0, 0}, {0, 1, 0});
            const double ratio = mean(renderer.image()).x / expected;
            EXPECT_LT(error_of_mean, 0.001);
            EXPECT_NEAR(ratio, 1, std::min(3 * error_of_mean + 1e-4, 0.005))
                << corners[0].x << (turned ? " turned" : "");
        }
}

// ---- multiple importance sampling -------------------------------------------------------------------------------

/// What the tests set, see TECHNIQUES in lights/light.clh.
class Techniques : public testing::TestWithParam<float> {
protected:
    struct Estimate {
        double mean, error;  // of the mean, relative
    };
    static Estimate rendered_with(const Scene& scene, unsigned techniques, Sampler sampler) {
        device().set_tuning("render/shade_surface", "TECHNIQUES", techniques);
        RenderConfig config{.width = 16, .height = 16, .spp = 1024, .max_depth = 1};
        config.sampler = sampler;
        // One program for all scenes without instances, one for all with them.
        config.effects.add =
            scene.instances.empty()
                ? effects_with(CLARAY_SAMPLED) | EffectSet{Effect::lambert, Effect::metal, Effect::many_lights,
                                                           Effect::textures, Effect::emission_maps}
                : EffectSet{Effect::many_lights};
        Renderer renderer(device(), scene, config);
        const double error = renderer.render().noise / 16;
        device().set_tuning("render/shade_surface", "TECHNIQUES", 3);
        return {mean(renderer.image()).x, error};
    }
    /// The weights take no light away and add none, and there is less noise than with the better of the techniques;
    /// with stratified numbers, too, unless a technique's samples are all alike (`alike`): light from a lamp, or from
    /// an environment that is chosen by its radiance, is a smooth function of two numbers, and its error falls a good
    /// deal faster than that of two weighted parts (environment: 2.5e-5 against 1.2e-4 here; 1.2e-3 and 1.1e-3 with
    /// independent numbers).
    static void expect_agreement(const Scene& scene, bool alike = false) {
        for (const Sampler sampler : {Sampler::sobol, Sampler::independent}) expect_agreement_by(sampler, scene, alike);
    }
    static void expect_agreement_by(Sampler sampler, const Scene& scene, bool alike = false) {
        const Estimate both = rendered_with(scene, 3, sampler), lights = rendered_with(scene, 1, sampler),
                       bsdfs = rendered_with(scene, 2, sampler);
        EXPECT_GT(both.mean, 0.01);
        EXPECT_NEAR(lights.mean / both.mean, 1, 3 * std::hypot(both.error, lights.error) + 1e-4);
        EXPECT_NEAR(bsdfs.mean / both.mean, 1, 3 * std::hypot(both.error, bsdfs.error) + 1e-4);
        if (sampler == Sampler::independent || !alike) {
            EXPECT_LT(both.error, 1.2 * std::min(lights.error, bsdfs.error) + 2e-5);
        }
    }
    static Scene bare() {
        Scene scene;
        scene.materials = {material(GetParam() > 0 ? MaterialKind::metal : MaterialKind::lambert, 0.8f, GetParam())};
        scene.meshes = {square(20.f, 0.f)};
        scene.camera = narrow_camera({-1, 0.7f, 0}, {0, 0, 0});
        return scene;
    }
};

TEST_P(Techniques, AgreeOnALamp) {
    Scene scene = bare();
    scene.materials.push_back(emitter(2.f));
    scene.meshes.push_back(square(0.6f, 1.f, 1));
    for (glm::vec3& p : scene.meshes[1].positions) p.x += 1.2f;
    expect_agreement(scene, true);
}

/// Lights with an extent that are no triangles, and not what a program adds to the list.
TEST_P(Techniques, AgreeOnLightsThatAreSeen) {
    for (const LightTraits& kind : light_kinds) {
        if (!kind.seen) continue;
        Scene scene = bare();
        Light light = make_light(kind.kind, {1.2f, 1, 0}, {-1.2f, -1, 0}, 2.f);
        light.outer_angle = 0.3f;
        scene.lights = {light};
        expect_agreement(scene, true);
    }
}

TEST_P(Techniques, AgreeOnManyTriangles) {
    Scene scene = bare();
    scene.materials.push_back(emitter(2.f));
    for (int i = 0; i < 36; ++i) {
        scene.meshes.push_back(square(0.1f, 0.9f + 0.03f * float(i % 5), 1));
        for (glm::vec3& p : scene.meshes.back().positions)
            p += glm::vec3(0.6f + 0.22f * float(i % 6), 0, 0.22f * float(i / 6) - 0.6f);
    }
    ASSERT_FALSE(collect_lights(scene).tree.empty());
    expect_agreement(scene);
}

TEST_P(Techniques, AgreeOnAnEnvironment) {
    Scene scene = bare();
    Texture image;
    image.width = 32, image.height = 16, image.channels = 3, image.format = TexelFormat::float32;
    image.floats.assign(std::size_t(3) * 32 * 16, 0.2f);
    for (unsigned y = 3; y < 7; ++y)
        for (unsigned x = 20; x < 26; ++x)
            for (unsigned c = 0; c < 3; ++c) image.floats[3 * (y * 32 + x) + c] = float(3 + y + c);
    scene.environment.images = {image};
    expect_agreement(scene, true);
}

/// Lamps with an emission map: a point of a lamp emits the map's value there, not the average. An image does not depend
/// on where the numbers come from, so one sampler suffices for each scene.
class TechniquesWithImages : public Techniques {
protected:
    /// A lamp of a side of 2 * half, seen from below, with an image that is black in places.
    static Scene with_lamps(float half) {
        Scene scene = bare();
        scene.textures = {float_texture({8, 8}, [](double u, double v) { return std::max(0.0, 3 * u - v); })};
        scene.materials.push_back(emitter(2.f));
        scene.materials[1].emission_map.texture = 0;
        scene.materials[1].cull_back = true;
        scene.meshes.push_back(square(half, 1.f, 1));
        scene.meshes[1].uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        for (glm::uvec3& t : scene.meshes[1].triangles) std::swap(t.y, t.z);
        return scene;
    }
};

TEST_P(TechniquesWithImages, AgreeOnALamp) {
    Scene scene = with_lamps(0.6f);
    for (glm::vec3& p : scene.meshes[1].positions) p.x += 1.2f;
    expect_agreement_by(Sampler::independent, scene);
}

TEST_P(TechniquesWithImages, AgreeOnManyInInstances) {
    Scene scene = with_lamps(0.1f);
    scene.instances = {MeshInstance{}};
    for (int i = 0; i < 36; ++i) {
        MeshInstance instance;
        instance.mesh = 1;
        if (i % 3 == 0) instance.transform[0].x = -1.f;
        instance.transform[3] = {0.6f + 0.22f * float(i % 6), 0.03f * float(i % 5), 0.22f * float(i / 6) - 0.6f, 1};
        scene.instances.push_back(instance);
    }
    ASSERT_FALSE(collect_lights(scene).tree.empty());
    expect_agreement_by(Sampler::sobol, scene);
}

/// So near that the place of bright texels matters: the corners that a mirrored instance exchanges are distinguished.
TEST_P(TechniquesWithImages, AgreeOnMirroredLampsNearby) {
    Scene scene = with_lamps(0.6f);
    scene.instances = {MeshInstance{}};
    for (const float side : {-1.f, 1.f}) {
        MeshInstance instance;
        instance.mesh = 1;
        instance.transform[0].x = side;
        instance.transform[3] = {side * 0.7f, -0.75f, 0.1f, 1};
        scene.instances.push_back(instance);
    }
    const Estimate lights = rendered_with(scene, 1, Sampler::sobol), bsdfs = rendered_with(scene, 2, Sampler::sobol);
    EXPECT_NEAR(lights.mean / bsdfs.mean, 1, 3 * std::hypot(lights.error, bsdfs.error));
}

INSTANTIATE_TEST_SUITE_P(Roughness, TechniquesWithImages, testing::Values(0.4f));
INSTANTIATE_TEST_SUITE_P(Roughness, Techniques, testing::Values(0.f, 0.4f, 0.8f),
                         [](const auto& r) { return "Percent" + std::to_string(int(100 * r.param + 0.5f)); });

}  // namespace
}  // namespace claray::test
