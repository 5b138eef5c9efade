#include "host/lights/lights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "claray/program.hpp"
#include "claray/shared/rng.h"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// Lamps of very different size and radiance, and two point lights.
Scene many_lights() {
    Scene scene;
    scene.materials = {lambert(0.5f), emitter(1.f), emitter(7.f)};
    scene.meshes = {square(1.f, 0.f, 0), square(1.f, 2.f, 1), square(0.03f, 3.f, 2), square(5.f, 4.f, 2)};
    scene.lights = {point_light({0, 1, 0}, glm::vec3(10.f)), point_light({1, 1, 0}, glm::vec3(0.f)),
                    point_light({2, 1, 0}, glm::vec3(0.5f))};
    return scene;
}

std::vector<double> expected_shares() {
    std::vector<double> powers;
    for (const double power : {1.0 * 2, 1.0 * 2, 7 * 0.03 * 0.03 * 2, 7 * 0.03 * 0.03 * 2, 7.0 * 50, 7.0 * 50})
        powers.push_back(2 * 3.14159265358979 * power);
    for (const double intensity : {10.0, 0.5}) powers.push_back(4 * 3.14159265358979 * intensity);
    double total = 0;
    for (const double power : powers) total += power;
    for (double& power : powers) power /= total;
    return powers;
}

TEST(Lights, ProbabilitiesAreProportionalToPower) {
    const Lights lights = collect_lights(many_lights(), {.most_per_cell = 0});
    const std::vector<double> shares = expected_shares();
    ASSERT_EQ(lights.triangles.size(), 6u);
    ASSERT_EQ(lights.punctual.size(), 2u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(lights.triangles[i].probability / shares[i], 1, 1e-5) << i;
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(lights.punctual[i].probability / shares[6 + i], 1, 1e-5) << i;
    EXPECT_EQ(lights.punctual.back().cumulative, 0xffffffffu);
    // Density of a point on a lamp of radiance 7: the light's probability over its area.
    EXPECT_NEAR(7 * lights.data.density / (lights.triangles[4].probability / lights.triangles[4].area), 1, 1e-5);
}

TEST(Lights, KernelPicksByTheDistribution) {
    const Lights lights = collect_lights(many_lights(), {.most_per_cell = 0});
    Kernel kernel = compile_kernel(device(), R"(
        #include "lights/light.clh"
        kernel void pick(global const uint* random, global uint* picked, uint triangle_lights, uint lights,
                         global const TriangleLight* triangles, global const PunctualLight* punctual) {
            const uint i = get_global_id(0);
            picked[i] = pick_light(random[i], 0, triangle_lights, lights, triangles, punctual);
        })",
                                   "pick");
    const std::uint32_t count = 1u << 20;
    std::vector<std::uint32_t> random(count);
    for (std::uint32_t i = 0; i < count; ++i) random[i] = hash_word(i);
    random[0] = 0, random[1] = 0xffffffffu;
    for (std::size_t i = 0; i < 6; ++i) {  // both sides of every border
        random[2 + 2 * i] = lights.triangles[i].cumulative;
        random[3 + 2 * i] = lights.triangles[i].cumulative + 1;
    }
    const Buffer<std::uint32_t> input(device(), random), output(device(), count);
    kernel.run({count}, input, output, 6u, 8u, Buffer<TriangleLight>(device(), lights.triangles),
               Buffer<PunctualLight>(device(), lights.punctual));
    const std::vector<std::uint32_t> picked = output.read();
    EXPECT_EQ(picked[0], 0u);
    EXPECT_EQ(picked[1], 7u);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(picked[2 + 2 * i], i);
        EXPECT_EQ(picked[3 + 2 * i], i + 1);
    }
    std::vector<double> counts(8);
    for (const std::uint32_t light : picked) ++counts[light];
    const std::vector<double> shares = expected_shares();
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR(counts[i], shares[i] * count, 5 * std::sqrt(shares[i] * count) + 14) << "light " << i;
}

TEST(Lights, NoLightIsLostToRounding) {
    Scene scene;
    scene.materials = {emitter(1e-12f), emitter(1e12f)};
    scene.meshes = {square(1.f, 0.f, 0), square(1.f, 1.f, 1), square(1.f, 2.f, 0)};
    std::uint32_t before = 0;
    for (const TriangleLight& light : collect_lights(scene).triangles) {
        EXPECT_GT(light.probability, 0.f);
        EXPECT_GE(light.cumulative, before);
        before = light.cumulative + 1;
    }
    EXPECT_EQ(before, 0u) << "the last light's numbers end at 2^32";
}

TEST(Lights, TrianglesThatCannotBeHitGiveNoLight) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    Mesh mesh = square(1.f, 0.f);
    mesh.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
    mesh.positions.push_back({1e19f, 0, 0});
    mesh.triangles = {{0, 1, 4}, {0, 1, 5}, {0, 1, 1}, {0, 1, 2}};
    mesh.materials = {};
    scene.meshes = {mesh};
    const Lights lights = collect_lights(scene);
    ASSERT_EQ(lights.triangles.size(), 1u);
    EXPECT_EQ(lights.triangles[0].primitive, 3u);
}

/// A floor below a lamp of `cuts` x `cuts` squares of two triangles each; of 0: one triangle.
Scene under_lamp(unsigned cuts) {
    Scene scene;
    scene.materials = {lambert(0.7f), emitter(10.f)};
    Mesh lamp;
    const unsigned n = std::max(cuts, 1u);
    for (unsigned i = 0; i <= n; ++i)
        for (unsigned k = 0; k <= n; ++k) lamp.positions.emplace_back(float(i) / n - 0.5f, 1.5f, float(k) / n - 0.5f);
    for (unsigned i = 0; i < n; ++i)
        for (unsigned k = 0; k < n; ++k) {
            const unsigned at = i * (n + 1) + k;
            lamp.triangles.emplace_back(at, at + n + 1, at + 1);
            if (cuts > 0) lamp.triangles.emplace_back(at + 1, at + n + 1, at + n + 2);
        }
    lamp.materials.assign(lamp.triangles.size(), 1);
    scene.meshes = {square(4.f, 0.f), lamp};
    scene.camera = Camera{.position = {0, 1.4f, 0.1f}, .target = {0, 0, 0}, .vertical_fov = 4};
    return scene;
}

/// Variance of the pixels over seeds.
double noise_square(const Scene& scene, unsigned spp) {
    constexpr unsigned side = 16, seeds = 4;
    std::vector<std::vector<glm::vec3>> images;
    for (unsigned seed = 1; seed <= seeds; ++seed)
        images.push_back(
            render_image(scene, {.width = side, .height = side, .spp = spp, .max_depth = 1, .seed = seed}));
    double sum = 0;
    for (unsigned p = 0; p < side * side; ++p) {
        double mean = 0, squares = 0;
        for (const auto& image : images) mean += image[p].x / seeds;
        for (const auto& image : images) squares += (image[p].x - mean) * (image[p].x - mean);
        sum += squares / (seeds - 1) / (side * side);
    }
    return sum;
}

/// Choosing the triangle by a number of its own would let the error fall by the root of the samples: a factor of 16 for
/// its square. From 16 triangles on a tree chooses, whose shares do not divide the Sobol points evenly.
TEST(Lights, DirectLightConvergesWithTheSamplesForAnyNumberOfTriangles) {
    const std::map<unsigned, double> least = {{0, 128}, {1, 128}, {2, 128}, {4, 64}};
    for (const auto& [cuts, factor] : least) {
        const Scene scene = under_lamp(cuts);
        EXPECT_GT(noise_square(scene, 16), factor * noise_square(scene, 256)) << cuts;
    }
}

}  // namespace
}  // namespace claray::test
