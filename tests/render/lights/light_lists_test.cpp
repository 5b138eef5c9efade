// Lights with a position are picked from the lists of a grid: host/lights/light_lists.cpp, lights/light_lists.clh.
#include "host/lights/light_lists.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "claray/program.hpp"
#include "host/lights/lights.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/statistics.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

/// Points and spots over a floor, with ranges from 0.3 to 1.5 times `range`.
Scene lit_floor(unsigned lights, float range) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    Scene scene;
    scene.materials = {lambert(0.8f)};
    scene.meshes = {square(6.f, 0.f)};
    for (unsigned i = 0; i < lights; ++i) {
        Light light = point_light({5 * unit(random), 1 + 0.8f * unit(random), 5 * unit(random)},
                                  glm::vec3(1.2f + unit(random), 1.f, 1.f - 0.5f * unit(random)));
        if (i % 2 == 1) {
            light.kind = LightKind::spot;
            light.direction = {unit(random), -1.f, unit(random)};
            light.inner_angle = 0.2f + 0.1f * unit(random), light.outer_angle = i % 4 == 1 ? light.inner_angle : 0.6f;
        }
        light.range = range * (0.9f + 0.6f * unit(random));
        light.linear_range = i % 3 == 0;
        scene.lights.push_back(light);
    }
    return scene;
}

const char* grid_kernels = R"(
    #include "lights/light.clh"
    /// The irradiance of all lights, and that of the lights of the point's list.
    kernel void sums(global const uint* grid, global const PunctualLight* lights, uint count, global const float* places,
                     uint points, global float* of_all, global float* of_list, global uint* lengths) {
        const uint i = get_global_id(0);
        if (i >= points) return;
        const float3 from = vload3(2 * i, places), normal = vload3(2 * i + 1, places);
        float all = 0.0f, listed = 0.0f;
        for (uint k = 0; k < count; ++k) all += irradiance_of(lights + k, from, normal);
        const LightList list = list_at(grid, from);
        for (uint k = 0; k < list.count; ++k) listed += irradiance_of(lights + list.lights[k], from, normal);
        of_all[i] = all, of_list[i] = listed, lengths[i] = list.count;
    }
    kernel void pick(global const uint* grid, global const PunctualLight* lights, float x, float y, float z,
                     global const float* random, uint count, global uint* light, global float* probability) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        const ListPick pick = pick_from_lists(grid, lights, (float3)(x, y, z), (float3)(0.0f, 1.0f, 0.0f), random[i]);
        light[i] = pick.light, probability[i] = pick.probability;
    })";

/// Also of points on the borders of cells and outside the grid.
std::vector<float> places_and_normals(const LightLists& grid, unsigned count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    std::vector<float> values;
    for (unsigned i = 0; i < count; ++i) {
        glm::vec3 at(6 * unit(random), 1 + 2 * unit(random), 6 * unit(random));
        if (i % 3 == 0) at.x = grid.x + float(i % (grid.width + 1)) / grid.cells_per_length;
        if (i % 5 == 0) at.y = grid.y + float(i % (grid.height + 1)) / grid.cells_per_length;
        const glm::vec3 normal =
            i % 7 == 0 ? glm::vec3(0.f) : glm::normalize(glm::vec3(unit(random), unit(random), unit(random)));
        values.insert(values.end(), {at.x, at.y, at.z, normal.x, normal.y, normal.z});
    }
    return values;
}

/// Also if a few lights have no range: they are in every list and in that of what is outside the grid.
TEST(LightLists, ListsGiveTheSumOverAllLightsBitForBit) {
    for (const auto& [range, unlimited] : {std::pair{0.2f, 0}, {1.f, 0}, {3.f, 0}, {1.f, 8}}) {
        Scene scene = lit_floor(300, range);
        for (int i = 0; i < unlimited; ++i)
            scene.lights[std::size_t(i)].range = 0, scene.lights[std::size_t(i)].linear_range = false;
        const Lights lights = collect_lights(scene, {.most_per_cell = 1e6});
        ASSERT_EQ(lights.listed(), 300u);
        EXPECT_EQ(lights.data.count, 0u);
        const Buffer<std::uint32_t> grid(device(), lights.lists);
        const Buffer<PunctualLight> all(device(), lights.punctual);
        LightLists header;
        std::memcpy(&header, lights.lists.data(), sizeof header);
        const std::uint32_t points = 20'000;
        const Buffer<float> places(device(), places_and_normals(header, points)), of_all(device(), points),
            of_list(device(), points);
        const Buffer<std::uint32_t> lengths(device(), points);
        compile_kernel(device(), grid_kernels, "sums")
            .run({points}, grid, all, 300u, arg("places", places), points, arg("of_all", of_all),
                 arg("of_list", of_list), arg("lengths", lengths));
        EXPECT_EQ(of_all.read(), of_list.read());
        double lit = 0, listed = 0;
        for (const float sum : of_all.read()) lit += sum > 0;
        for (const std::uint32_t length : lengths.read()) listed += length;
        EXPECT_GT(lit, 0.003 * points);
        EXPECT_LT(listed / points, unlimited + (range > 2 ? 150 : 40)) << "as if each list had most lights";
    }
}

TEST(LightLists, PicksByIrradiance) {
    const Lights lights = collect_lights(lit_floor(200, 2.f));
    ASSERT_EQ(lights.listed(), 200u);
    const std::uint32_t count = 1u << 18;
    std::mt19937 generator(2);
    std::uniform_real_distribution<float> unit(0.f, 1.f);
    std::vector<float> random(count);
    for (float& value : random) value = unit(generator);
    random[0] = 0, random[1] = 0.99999994f;
    const Buffer<std::uint32_t> grid(device(), lights.lists), picked(device(), count);
    const Buffer<PunctualLight> all(device(), lights.punctual);
    const Buffer<float> input(device(), random), probability(device(), count);
    Kernel pick = compile_kernel(device(), grid_kernels, "pick");
    for (const glm::vec3 from : {glm::vec3(0, 0, 0), glm::vec3(2, 0.5f, -1), glm::vec3(-4, 0.01f, 4)}) {
        pick.run({count}, grid, all, from.x, from.y, from.z, arg("random", input), count, arg("light", picked),
                 arg("probability", probability));
        std::vector<double> observed(200), expected(200);
        const std::vector<std::uint32_t> chosen = picked.read();
        const std::vector<float> shares = probability.read();
        for (std::uint32_t i = 0; i < count; ++i) {
            ASSERT_GT(shares[i], 0.f);
            ++observed[chosen[i]], expected[chosen[i]] = double(count) * shares[i];
        }
        double total = 0;
        for (const double value : expected) total += value / count;
        EXPECT_NEAR(total, 1, 2e-3) << "all lights that matter are picked by 262,144 numbers";
        const ChiSquared chi2 = chi_squared(observed, expected);
        EXPECT_TRUE(chi2.plausible()) << chi2.value << " for " << chi2.degrees << " degrees of freedom";
    }
}

const char* kernel_of_sixteen = R"(
    #include "lights/light_lists_sixteen.clh"
    /// One light for each place, by one surface and by sixteen together.
    kernel void pick_both(global const uint* grid, global const PunctualLight* lights, global const float* places, uint count,
                          global const float* random, global ListPick* alone, global ListPick* together) {
        const uint first = 16 * get_global_id(0);
        if (first >= count) return;
        Lanes16 lanes = {{{0.0f}}};
        ListPick picks[16];
        uint wanted = 0;
        for (uint k = 0; k < 16; ++k) {
            const float3 from = vload3(2 * (first + k), places), normal = vload3(2 * (first + k) + 1, places);
            alone[first + k] = pick_from_lists(grid, lights, from, normal, random[first + k]);
            keep_vector16(from, &lanes, ROW_LIST_FROM, k), keep_vector16(normal, &lanes, ROW_LIST_NORMAL, k);
            lanes.value[ROW_LIST_RANDOM][k] = random[first + k];
            if (k % 5 != 4) wanted |= 1u << k;
        }
        pick_from_lists16(grid, lights, &lanes, wanted, picks);
        for (uint k = 0; k < 16; ++k) together[first + k] = wanted & 1u << k ? picks[k] : alone[first + k];
    })";

struct ListPick {
    std::uint32_t light;
    float probability;
    float irradiance;
};

/// Sixteen surfaces in one cell, in several, and in cells whose lists are too long for them
/// (lights/light_lists_sixteen.clh).
TEST(LightLists, SixteenPickAsOne) {
    if (device().info().type != DeviceType::cpu) GTEST_SKIP() << "only CPUs pick for sixteen surfaces at once";
    Kernel pick = compile_kernel(device(), kernel_of_sixteen, "pick_both");
    for (const auto& [count, range] : {std::pair{300u, 1.f}, {200u, 3.f}, {500u, 6.f}}) {
        const Lights lights = collect_lights(lit_floor(count, range), {.most_per_cell = 1e6});
        LightLists header;
        std::memcpy(&header, lights.lists.data(), sizeof header);
        const std::uint32_t points = 16 * 256;
        std::vector<float> places = places_and_normals(header, points), random(points);
        for (std::uint32_t i = 0; i < points / 2; ++i)  // neighbours
            for (int k = 0; k < 3; ++k)
                places[6 * i + std::size_t(k)] = places[6 * (i / 16 * 16) + std::size_t(k)] + 1e-3f * float(i % 16);
        std::mt19937 generator(3);
        std::uniform_real_distribution<float> unit(0.f, 1.f);
        for (float& value : random) value = unit(generator);
        const Buffer<std::uint32_t> grid(device(), lights.lists);
        const Buffer<PunctualLight> all(device(), lights.punctual);
        const Buffer<float> at(device(), places), numbers(device(), random);
        const Buffer<ListPick> alone(device(), points), together(device(), points);
        pick.run({points / 16}, grid, all, arg("places", at), points, arg("random", numbers), arg("alone", alone),
                 arg("together", together));
        const std::vector<ListPick> one = alone.read(), sixteen = together.read();
        unsigned lit = 0, others = 0;
        for (std::uint32_t i = 0; i < points; ++i) {
            lit += one[i].probability > 0;
            EXPECT_EQ(one[i].probability > 0, sixteen[i].probability > 0) << i;
            others += one[i].light != sixteen[i].light;  // rounding may move the border between two lights
            if (one[i].light != sixteen[i].light) continue;
            EXPECT_NEAR(one[i].probability, sixteen[i].probability, 1e-4f) << i;
            EXPECT_NEAR(one[i].irradiance, sixteen[i].irradiance, 1e-4f * one[i].irradiance) << i;
        }
        EXPECT_GT(lit, points / 8);
        EXPECT_LE(others, points / 1000) << count << " lights";
    }
}

/// Without shadows, the light of a diffuse surface has no noise, and it is the sum in closed form.
TEST(LightLists, LightsADiffuseFloorWithoutNoise) {
    Scene scene = lit_floor(400, 1.5f);
    const glm::dvec3 at(0.7, 0, -0.4);
    scene.camera = narrow_camera(glm::vec3(at) + glm::vec3(0.f, 3.f, 0.f), glm::vec3(at));
    scene.camera->up = {0, 0, 1};
    glm::dvec3 expected(0.0);
    for (const Light& light : scene.lights) {
        const glm::dvec3 towards = glm::dvec3(light.position) - at;
        const double d = glm::length(towards), share = d / light.range;
        if (share >= 1) continue;
        double inside = 1;
        if (light.kind == LightKind::spot) {
            const double cosine = glm::dot(glm::normalize(glm::dvec3(light.direction)), -towards / d);
            const double outer = std::cos(double(light.outer_angle)), inner = std::cos(double(light.inner_angle));
            inside = std::clamp((cosine - outer) / std::max(inner - outer, 1e-12), 0.0, 1.0);
        }
        const double window = 1 - (light.linear_range ? share : std::pow(share, 4));
        expected += glm::dvec3(light.intensity) * (0.8 / pi * towards.y / (d * d * d) * window * inside * inside);
    }
    ASSERT_GT(expected.y, 0);
    // All paths go to the grid: no other light is there. Colours differ, so that one sample does not suffice.
    Renderer renderer(device(), scene, {.width = 4, .height = 4, .spp = 256, .max_depth = 1});
    EXPECT_LT(renderer.render().noise, 1e-4) << "of luminance, by which lights are picked";
    const glm::dvec3 found = mean(renderer.image());
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k] / expected[k], 1, 0.02);
    const auto luminance = [](const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
    EXPECT_NEAR(luminance(found) / luminance(expected), 1, 1e-4);
}

/// On CPUs lights of Lambertian surfaces are sampled for sixteen of them at once, and the surfaces at the ends of paths
/// found so, too. Oren-Nayar surfaces without roughness reflect the same light and are shaded one by one.
TEST(LightLists, SixteenDiffuseSurfacesReflectAsOne) {
    Scene scene = lit_floor(300, 2.f);
    scene.meshes.push_back(square(2.f, 0.5f));
    scene.meshes[1].normals = {{-0.8f, 0.6f, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0.8f, -0.6f}};
    scene.camera = narrow_camera({3, 6, 4}, {0, 0, 0});
    scene.camera->vertical_fov = 1.2f;
    const auto image_of = [&](MaterialKind kind, unsigned depth) {
        scene.materials[0].kind = kind, scene.materials[0].roughness = 0;
        Renderer renderer(device(), scene, {.width = 64, .height = 48, .spp = 2, .max_depth = depth});
        (void)renderer.render();
        return renderer.image();
    };
    for (const unsigned depth : {1u, 2u}) {
        const std::vector<glm::vec3> sixteen = image_of(MaterialKind::lambert, depth);
        const std::vector<glm::vec3> one = image_of(MaterialKind::oren_nayar, depth);
        unsigned lit = 0, others = 0;
        for (std::size_t i = 0; i < one.size(); ++i) {
            lit += one[i].y > 0;
            others += glm::length(one[i] - sixteen[i]) > 1e-3f * glm::length(one[i]);  // another light, by rounding
        }
        EXPECT_GT(lit, one.size() / 2);
        EXPECT_LE(others, one.size() / 500) << "depth " << depth;
    }
}

/// Beside lights of all other kinds: each group has its numbers.
TEST(LightLists, SharesWithOtherLights) {
    Scene scene = lit_floor(60, 1.5f);
    for (int i = 0; i < 140; ++i)  // too many for lists
        scene.lights.push_back(point_light({0.06f * float(i) - 4, 2, 1}, glm::vec3(0.04f)));
    Light sun;
    sun.kind = LightKind::directional, sun.intensity = glm::vec3(0.2f);
    scene.lights.push_back(sun);
    scene.camera = Camera{{0, 6, 6}, {0, 0, 0}, {0, 1, 0}, 40.f};
    const RenderConfig config{.width = 16, .height = 16, .spp = 256, .max_depth = 1};
    glm::dvec3 sum(0.0);
    double variance = 0;
    const auto add = [&](const auto& keep) {
        Scene part = scene;
        std::erase_if(part.lights, [&](const Light& light) { return !keep(light); });
        Renderer renderer(device(), part, config);
        const double noise = renderer.render().noise / 16;
        sum += mean(renderer.image());
        variance += std::pow(noise * mean(renderer.image()).y, 2);
    };
    add([](const Light& light) { return light.range > 0; });
    add([](const Light& light) { return light.range == 0 && light.kind == LightKind::point; });
    add([](const Light& light) { return light.kind == LightKind::directional; });
    Renderer renderer(device(), scene, config);
    const double noise = renderer.render().noise / 16, all = mean(renderer.image()).y;
    EXPECT_NEAR(all, sum.y, 3 * std::sqrt(variance + noise * noise * all * all) + 1e-4 * all);
}

/// Three lights without a range, each close to another part of the floor: no light is picked where it gives little.
TEST(LightLists, FewLightsWithoutRangeHaveLessNoise) {
    Scene scene;
    scene.materials = {lambert(0.8f)};
    scene.meshes = {square(6.f, 0.f)};
    scene.lights = {point_light({-4, 0.7f, 0}, glm::vec3(1.f)), point_light({4, 0.7f, 1}, glm::vec3(1.f)),
                    point_light({0, 0.9f, -4}, glm::vec3(1.5f))};
    scene.camera = Camera{{0, 9, 9}, {0, 0, 0}, {0, 1, 0}, 50.f};
    RenderConfig config{.width = 32, .height = 32, .spp = 64, .max_depth = 1};
    Renderer with(device(), scene, config);
    config.effects.remove = {Effect::light_lists};
    Renderer without(device(), scene, config);
    const double less = with.render().noise, more = without.render().noise;
    EXPECT_LT(less, 0.6 * more);
    const double mean_with = mean(with.image()).y, mean_without = mean(without.image()).y;
    EXPECT_NEAR(mean_with / mean_without, 1, 3 * std::hypot(less, more) / 32 + 1e-4);
}

/// Lights behind rough glass, from where they are seen and from where they are not.
TEST(LightLists, ShineThroughSurfaces) {
    Scene scene;
    scene.materials = {lambert(0.8f), lambert(0.8f)};
    scene.materials[0].kind = MaterialKind::glass, scene.materials[0].roughness = 0.4f;
    scene.meshes = {square(6.f, 1.f, 0), square(6.f, -1.f, 1)};
    scene.lights = {point_light({-1, 0, 0}, glm::vec3(1.f)), point_light({1, 0.2f, 0.5f}, glm::vec3(2.f))};
    scene.camera = Camera{{0, 4, 3}, {0, 0, 0}, {0, 1, 0}, 50.f};
    for (const bool above : {false, true}) {
        if (above) scene.lights.push_back(point_light({2, 2, 0}, glm::vec3(0.5f)));
        RenderConfig config{.width = 16, .height = 16, .spp = 1024, .max_depth = 2};
        Renderer with(device(), scene, config);
        config.effects.remove = {Effect::light_lists};
        Renderer without(device(), scene, config);
        const double noise = std::hypot(with.render().noise, without.render().noise) / 16;
        ASSERT_LT(noise, 0.02);
        EXPECT_NEAR(mean(with.image()).y / mean(without.image()).y, 1, 3 * noise) << above;
    }
}

/// Exporters write such ranges for lights without an end.
TEST(LightLists, RangesFarBeyondTheSceneAreNone) {
    Scene scene = lit_floor(40, 1.f);
    for (Light& light : scene.lights) light.range = 0, light.linear_range = false;
    const RenderConfig config{.width = 16, .height = 16, .spp = 8, .max_depth = 2};
    const std::vector<glm::vec3> unlimited = render_image(scene, config);
    EXPECT_GT(mean(unlimited).y, 0.01);
    for (const float range : {1e4f, 1e18f, 1e30f, 3e38f}) {
        for (Light& light : scene.lights) light.range = range;
        EXPECT_TRUE(same_bits(render_image(scene, config), unlimited)) << range;
        for (Light& light : scene.lights) light.linear_range = true;
        EXPECT_NEAR(mean(render_image(scene, config)).y / mean(unlimited).y, 1, 0.02) << "linear, " << range;
        for (Light& light : scene.lights) light.linear_range = false;
    }
}

/// A street of lamps is longer than the grid has cells of a lamp's size: every lamp is in the list of its place.
TEST(LightLists, ReachAlongLongRows) {
    Scene scene = lit_floor(1, 1.f);
    scene.lights.clear();
    for (int i = 0; i < 1000; ++i) {
        scene.lights.push_back(point_light({100.f * float(i), 1, 0}, glm::vec3(1.f)));
        scene.lights.back().range = 10.f;
    }
    const Lights lights = collect_lights(scene);
    ASSERT_EQ(lights.listed(), 1000u);
    EXPECT_GE(mean_list_length(lights.punctual), 1);
    EXPECT_LT(mean_list_length(lights.punctual), 3);
}

/// Lists stay short: the lights of the longest ranges are left to the tree.
TEST(LightLists, LeavesWideRangesToTheTree) {
    Scene scene = lit_floor(100, 0.5f);
    const Scene wide = lit_floor(100, 100.f);
    scene.lights.insert(scene.lights.end(), wide.lights.begin(), wide.lights.end());
    const Lights lights = collect_lights(scene, {.most_per_cell = 30});
    EXPECT_GE(lights.listed(), 50u);
    EXPECT_LE(lights.listed(), 100u);
    EXPECT_EQ(lights.data.near, 200 - lights.listed());
    EXPECT_LE(mean_list_length(std::span(lights.punctual).last(lights.listed())), 30);
    EXPECT_FALSE(lights.tree.empty());
}

}  // namespace
}  // namespace claray::test
