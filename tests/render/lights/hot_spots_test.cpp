// Rays that go to point lights beside surfaces: host/lights/hot_spots.cpp, lights/light_hot_spot.clh.
#include "host/lights/hot_spots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "claray/program.hpp"
#include "host/lights/lights.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

/// Points in the dark Cornell box, some of them very close to its walls and blocks.
Scene box_with_points(int count) {
    Scene scene = *builtin_scene("cornell");
    for (Material& m : scene.materials) m.emission = glm::vec3(0.f);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.f, 1.f);
    for (int i = 0; i < count; ++i) {
        glm::vec3 at(0.05f + 0.45f * unit(random), 0.05f + 0.4f * unit(random), 0.05f + 0.45f * unit(random));
        if (i % 4 == 0) at.y = 0.001f * float(1 + i % 5);  // above the floor
        scene.lights.push_back(point_light(at, glm::vec3(0.1f, 0.2f, 0.1f)));
    }
    return scene;
}

glm::dvec3 centroid(const Mesh& mesh, std::size_t triangle) {
    const glm::uvec3 t = mesh.triangles[triangle];
    return (glm::dvec3(mesh.positions[t.x]) + glm::dvec3(mesh.positions[t.y]) + glm::dvec3(mesh.positions[t.z])) / 3.0;
}

/// In a sphere light that was reflected once is the same everywhere: the flux over the area, wherever the light is.
TEST(HotSpots, SphereIsLitEvenlyByAPointAtItsWall) {
    for (const double height : {0.1, 0.0003})
        for (const int lights : {1, 20, -20}) {  // by power, by the tree, and from lists
            Scene scene;
            scene.materials = {lambert(0.5f)};
            scene.meshes = {sphere(5)};
            const glm::dvec3 wall = centroid(scene.meshes[0], 7), at = (1 - height / glm::length(wall)) * wall;
            for (int i = 0; i < std::abs(lights); ++i)
                scene.lights.push_back(point_light(glm::vec3(at), glm::vec3(float(pi / std::abs(lights)))));
            scene.camera = Camera{{0, 0, 0}, glm::vec3(-at), {0.3f, 1, 0.2f}, 2.f};
            double area = 0;
            for (const glm::uvec3& t : scene.meshes[0].triangles) {
                const auto& p = scene.meshes[0].positions;
                area += 0.5 * glm::length(glm::cross(glm::dvec3(p[t.y] - p[t.x]), glm::dvec3(p[t.z] - p[t.x])));
            }
            const double direct = 0.5 / std::pow(1 + glm::length(at), 2);
            for (const unsigned depth : {2u, 8u}) {
                const double reflected = (0.5 - std::pow(0.5, depth)) * 4 * pi / area;
                RenderConfig config{.width = 32, .height = 32, .spp = 256, .max_depth = depth};
                config.effects.add = {Effect::hot_spots};  // one kernel for both heights
                if (lights > 0) config.effects.remove = {Effect::light_lists};
                Renderer renderer(device(), scene, config);
                const double error = renderer.render().noise / 32;
                EXPECT_LT(error, 0.005) << height;
                EXPECT_NEAR(mean(renderer.image()).x / (direct + reflected), 1, 3 * error + 0.002)
                    << "height " << height << ", depth " << depth << ", " << lights << " lights";
            }
        }
}

/// The same light with and without, on every kind of material, with a tree and without.
TEST(HotSpots, ChangeNoImageButItsNoise) {
    Scene stage = *builtin_scene("effect:hot-spots");
    stage.lights[0].position.y = 0.15f;  // not so close that chance would need too many samples
    std::vector<Scene> scenes;
    for (const MaterialKind kind : {MaterialKind::lambert, MaterialKind::metal, MaterialKind::blinn_phong,
                                    MaterialKind::principled, MaterialKind::glass}) {
        scenes.push_back(stage);
        for (Material& m : scenes.back().materials) {
            m.kind = kind, m.roughness = 0.6f;
            if (kind == MaterialKind::blinn_phong) m.albedo *= 0.5f, m.specular = glm::vec3(0.2f), m.shininess = 5.f;
            if (kind == MaterialKind::principled) m.metallic = m.clearcoat = 0.3f, m.transmission = 0.2f;
        }
    }
    scenes.push_back(stage);
    for (Material& m : scenes.back().materials) m.kind = MaterialKind::glass, m.roughness = 0.6f, m.thin_walled = true;
    scenes.push_back(stage);
    scenes.back().lights.assign(20, stage.lights[0]);
    for (Light& light : scenes.back().lights) light.intensity *= 0.05f, light.position.y = 0.06f;
    scenes.back().lights[3].kind = LightKind::spot;
    scenes.push_back(scenes.back());  // the same from the lists of a grid
    for (Light& light : scenes.back().lights) light.range = 5.f;
    EffectSet all;  // so that two kernels compile
    for (const Scene& scene : scenes) all = all | effects_of(scene);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        RenderConfig config{.width = 24, .height = 16, .spp = 1024, .max_depth = 4};
        config.effects.add = all;
        ASSERT_TRUE(effects_of(scenes[i]).has(Effect::hot_spots));
        double means[2], errors[2];
        for (const bool without : {false, true}) {
            if (without) config.effects.add.remove(Effect::hot_spots), config.effects.remove = {Effect::hot_spots};
            Renderer renderer(device(), scenes[i], config);
            errors[without] = renderer.render().noise / std::sqrt(24. * 16.);
            means[without] = mean(renderer.image()).y;
        }
        EXPECT_NEAR(means[0] / means[1], 1, 4 * std::hypot(errors[0], errors[1])) << "scene " << i;
        EXPECT_LT(errors[0], 0.02) << "scene " << i;
    }
}

/// What they are for. The camera sees the ceiling, which the lights on the floor shine on by way of it.
TEST(HotSpots, TakeTheNoiseOfLightsAtSurfaces) {
    Scene scene = box_with_points(3);
    scene.camera = Camera{{0.278f, 0.28f, 0.04f}, {0.278f, 0.5f, 0.34f}, {0, 1, 0}, 55.f};
    RenderConfig config{.width = 32, .height = 32, .spp = 64};
    Renderer with(device(), scene, config);
    config.effects.remove = {Effect::hot_spots};
    Renderer without(device(), scene, config);
    // What hot spots take away are rare bright samples, which few renders without them have.
    const auto mean_square = [](Renderer& renderer, std::uint32_t renders) {
        double sum = 0;
        for (std::uint32_t seed = 0; seed < renders; ++seed) {
            renderer.restart(seed);
            const double noise = renderer.render().noise;
            sum += noise * noise / renders;
        }
        return sum;
    };
    EXPECT_LT(std::sqrt(mean_square(with, 4)), 0.25 * std::sqrt(mean_square(without, 40)));
}

/// Sixteen rays at once (render/shade_sixteen.clh), and however many paths a batch has.
TEST(HotSpots, BitsAreTheSameSixteenAtOnceAndInSlices) {
    for (const int count : {3, 40}) {
        const Scene scene = box_with_points(count);
        RenderConfig config{.width = 29, .height = 17, .spp = 13, .max_depth = 5};
        config.effects.remove = {Effect::light_lists};
        const std::vector<glm::vec3> image = render_image(scene, config);
        {
            const ScopedTuning tuning("render/wavefront", "PATHS", 500);
            EXPECT_TRUE(same_bits(image, render_image(scene, config)));
        }
        config.effects.add = {Effect::spot_lights};
        EXPECT_TRUE(same_bits(image, render_image(scene, config)));
    }
}

/// Against the nearest of a fine grid of points of every triangle.
TEST(HotSpots, NearestSurfacesAreFound) {
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    const auto anywhere = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
    for (const bool placed : {false, true}) {
        Scene scene;
        scene.materials = {lambert(0.5f)};
        scene.meshes.resize(1);
        Mesh& mesh = scene.meshes[0];
        for (std::uint32_t i = 0; i < 30; ++i) {
            const glm::vec3 at = anywhere();
            for (int k = 0; k < 3; ++k) mesh.positions.push_back(at + 0.3f * anywhere());
            mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        }
        if (placed) {
            scene.instances.resize(2);
            scene.instances[0].transform = glm::mat4(0.7f);
            scene.instances[0].transform[3] = {0.2f, 0, 0, 1};
            scene.instances[1].transform[3] = {0, 0.3f, 0, 1};
        }
        for (int i = 0; i < 40; ++i) scene.lights.push_back(point_light(anywhere(), glm::vec3(i == 0 ? 1e6f : 1.f)));
        const std::vector<HotSpotPlace> places = find_hot_spots(scene);
        ASSERT_EQ(places.size(), 1u) << "all others are too faint";
        double nearest = INFINITY;
        const int steps = 100;
        std::vector<glm::dmat4> transforms = {glm::dmat4(1.0)};
        if (placed) transforms = {glm::dmat4(scene.instances[0].transform), glm::dmat4(scene.instances[1].transform)};
        for (const glm::dmat4& transform : transforms)
            for (const glm::uvec3& t : mesh.triangles)
                for (int u = 0; u <= steps; ++u)
                    for (int v = 0; u + v <= steps; ++v) {
                        const glm::dvec3 p = (double(steps - u - v) * glm::dvec3(mesh.positions[t.x]) +
                                              double(u) * glm::dvec3(mesh.positions[t.y]) +
                                              double(v) * glm::dvec3(mesh.positions[t.z])) /
                                             double(steps);
                        const glm::dvec3 there(transform * glm::dvec4(p, 1.0));
                        nearest = std::min(nearest, glm::length(there - glm::dvec3(scene.lights[0].position)));
                    }
        const double found = glm::length(glm::dvec3(places[0].way));
        EXPECT_LE(found, nearest + 1e-6);
        EXPECT_GE(found, nearest - 0.01);
    }
}

TEST(HotSpots, AreWhereInverseSquaresHaveNoBound) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    const auto spots = [&](const Light& light) {
        scene.lights = {light};
        return find_hot_spots(scene).size();
    };
    Light light = point_light({0.2f, 0.01f, 0.3f}, glm::vec3(1.f));
    EXPECT_EQ(spots(light), 1u);
    EXPECT_LT(glm::length(find_hot_spots(scene)[0].way - glm::vec3(0, -0.01f, 0)), 1e-6f);
    light.position.y = -0.01f;
    EXPECT_EQ(spots(light), 1u);
    light.position.y = 0.f;
    EXPECT_EQ(spots(light), 0u) << "in the surface";
    light.position.y = 1.f;
    EXPECT_EQ(spots(light), 0u) << "far away";
    light.position.y = 0.01f, light.attenuation = {1.f, 0.f, 1.f};
    EXPECT_EQ(spots(light), 0u) << "bounded";
    light.attenuation = {0.f, 0.f, 1.f}, light.intensity = glm::vec3(0.f);
    EXPECT_EQ(spots(light), 0u) << "black";
    light.intensity = glm::vec3(1.f), light.kind = LightKind::spot;
    EXPECT_EQ(spots(light), 0u);
    light.kind = LightKind::point, light.range = 0.009f;
    EXPECT_EQ(spots(light), 0u) << "out of range";
    light.range = 0.011f;
    EXPECT_EQ(spots(light), 1u);
    scene.sky.zenith = glm::vec3(1e3f);
    EXPECT_EQ(spots(light), 0u) << "faint beside the sky";
    scene.sky = {};
    scene.meshes.clear();
    light.kind = LightKind::point;
    EXPECT_EQ(spots(light), 0u);
}

/// A light that is too faint for a ray of its own counts where others are beside it.
TEST(HotSpots, OfManyLightsAreOne) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    for (const float apart : {0.0005f, 0.5f}) {
        scene.lights.clear();
        for (int i = 0; i < 100; ++i)
            scene.lights.push_back(point_light({apart * float(i % 10), 0.05f, apart * float(i / 10)}, glm::vec3(1.f)));
        EXPECT_EQ(find_hot_spots(scene).size(), apart < 0.1f ? 100u : 0u) << apart;
    }
}

/// Each has its numbers, and their share is what the kernels take for its probability.
TEST(HotSpots, SharesAddUp) {
    const Lights lights = collect_lights(box_with_points(100), {.most_per_cell = 0});
    ASSERT_GT(lights.hot_spots.size(), 10u);
    ASSERT_EQ(lights.hot_spots.size(), lights.data.hot_spots);
    double next = 0;
    for (const HotSpot& spot : lights.hot_spots) {
        EXPECT_FLOAT_EQ(spot.probability, float((spot.last + 1.0 - next) / 4294967296.0));
        EXPECT_EQ(lights.punctual[spot.light].cone_scale, spot.probability);
        EXPECT_EQ(lights.leaves[spot.leaf].light, spot.light);
        next = spot.last + 1.0;
    }
    EXPECT_FLOAT_EQ(lights.data.not_to_hot_spots, float(1 - next / 4294967296.0));
    EXPECT_GE(lights.data.not_to_hot_spots, 0.874f);
    std::size_t of_lights = 0;
    for (const PunctualLight& light : lights.punctual) of_lights += light.cone_scale > 0.f;
    EXPECT_EQ(of_lights, lights.hot_spots.size());
}

/// The density integrates to 1, and directions follow it: the means of some functions of them are its integrals.
TEST(HotSpots, DirectionsFollowTheirDensity) {
    Kernel kernel = compile_kernel(device(), R"(
        #include "claray/shared/rng.h"
        #include "lights/light.clh"
        static float3 function_of(float3 d) { return (float3)(d.x, d.z * d.z, d.y > -0.5f ? 1.0f : 0.0f); }
        kernel void integrate(float x, float y, float z, float height, global float* by_density, global float* by_points) {
            const uint i = get_global_id(0), count = get_global_size(0);
            PunctualLight light;
            light.x = 0.1f, light.y = 0.2f, light.z = 0.3f;
            const float3 way = height * (float3)(0.48f, -0.6f, 0.64f), from = (float3)(x, y, z);
            light.direction_x = way.x, light.direction_y = way.y, light.direction_z = way.z;
            const float2 random = (float2)(((float)i + 0.5f) / (float)count, unit_float(reverse_bits(i)));
            const float cosine = 1.0f - 2.0f * random.x;  // uniform over the sphere
            const float3 d = (float3)(sqrt(1.0f - cosine * cosine) * cosine_and_sine(random.y), cosine);
            const float density = hot_spot_density(&light, from, d);
            vstore4((float4)(function_of(d), 1.0f) * density * 4.0f * PI, i, by_density);
            const float3 to = normalize(point_of_hot_spot(&light, random) - from);
            vstore4((float4)(function_of(to), hot_spot_density(&light, from, to) > 0.0f ? 1.0f : 0.0f), i, by_points);
        })",
                                   "integrate");
    const std::size_t count = 1u << 20;
    const Buffer<float> by_density(device(), 4 * count), by_points(device(), 4 * count);
    for (const glm::vec3 from : {glm::vec3(1, 1, 0.5f), glm::vec3(0.3f, -1, 0.4f), glm::vec3(0.1f, 0.25f, 0.3f)})
        for (const float height : {0.3f, 1.f}) {
            kernel.run({count}, from.x, from.y, from.z, height, by_density, by_points);
            const std::vector<float> density = by_density.read(), points = by_points.read();
            double integral[4] = {}, average[4] = {};
            for (std::size_t i = 0; i < 4 * count; ++i)
                integral[i % 4] += density[i] / double(count), average[i % 4] += points[i] / double(count);
            for (int k = 0; k < 4; ++k)
                EXPECT_NEAR(integral[k], average[k], 0.003) << k << " " << height << " " << from.x;
            EXPECT_NEAR(integral[3], 1, 0.003) << height << " " << from.x;
        }
}

}  // namespace
}  // namespace claray::test
