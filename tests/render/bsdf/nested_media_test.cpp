// Bodies of glass and liquid with something within (kernels/shade/media.clh), against closed forms along one line.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/effects.hpp"
#include "host/effects/parts/part.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// The materials of nested bodies by their rank.
std::vector<std::uint32_t> nested_media(const Scene& scene) {
    std::vector<std::uint32_t> found;
    part_of(Effect::nested_media).find({scene, {}}, [&](const char*, const std::string&, std::size_t material) {
        found.push_back(std::uint32_t(material));
    });
    return found;
}

/// A box of glass with outward faces.
void add_body(Scene& scene, const glm::vec3& lo, const glm::vec3& hi, float ior, float left_after_1 = 1.f) {
    Mesh box;
    for (int corner = 0; corner < 8; ++corner)
        box.positions.push_back(glm::mix(lo, hi, glm::vec3(corner & 1, corner >> 1 & 1, corner >> 2)));
    box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                     {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    box.materials.assign(box.triangles.size(), std::uint32_t(scene.materials.size()));
    Material glass = material(MaterialKind::glass, 1.f);
    glass.ior = ior, glass.attenuation = glm::vec3(left_after_1), glass.attenuation_distance = 1.f;
    scene.materials.push_back(glass);
    scene.meshes.push_back(box);
}

/// Looks down on a square of the material at this height.
Scene seen_from_above(const Material& m, float height) {
    Scene scene;
    scene.materials = {m};
    scene.meshes = {square(0.9f, height)};
    scene.camera = narrow_camera({0.013f, 6.f, 0.017f}, {0.013f, 0.f, 0.017f});
    return scene;
}

double seen(const Scene& scene, unsigned depth = 64) {
    return mean(render_by_own_kernels(scene, {.width = 8, .height = 8, .spp = 4096, .max_depth = depth})).x;
}

double reflected(double from, double to) { return std::pow((from - to) / (from + to), 2); }

/// What a stack of layers lets pass at right angles, with all reflections among the borders.
double passed(std::initializer_list<double> iors) {
    double sum = 1, before = 1;
    for (const double ior : iors) {
        const double r = reflected(before, ior);
        sum += r / (1 - r), before = ior;
    }
    return 1 / sum;
}

/// Radiance falls by the square of the index where light leaves the body: glass that absorbs nothing adds no light.
TEST(NestedMedia, LampsInGlassAreNoBrighter) {
    Scene scene = seen_from_above(emitter(4.f), 0.f);
    scene.materials[0].albedo = glm::vec3(0.f);
    EXPECT_NEAR(seen(scene), 4, 1e-4);
    add_body(scene, glm::vec3(-1.f), glm::vec3(1.f), 1.5f);
    EXPECT_EQ(nested_media(scene), std::vector<std::uint32_t>{1});
    EXPECT_NEAR(seen(scene), 4 * 0.96 / 2.25, 0.03);
    scene.materials[1].attenuation = glm::vec3(0.5f);
    EXPECT_NEAR(seen(scene), 0.5 * 4 * 0.96 / 2.25, 0.015) << "a length of 1";
}

/// Light of a lamp with an area arrives in the same way, whether it is sampled or met.
TEST(NestedMedia, LampsLightWhatIsBesideThemInGlass) {
    Scene scene = seen_from_above(lambert(0.5f), -0.5f);
    add_body(scene, glm::vec3(-1.f), glm::vec3(1.f), 1.5f, 0.6f);
    Mesh lamp = square(0.2f, 0.5f, 2);
    for (glm::vec3& p : lamp.positions) p.x += 0.6f;
    for (glm::uvec3& t : lamp.triangles) std::swap(t.y, t.z);
    scene.meshes.push_back(lamp), scene.materials.push_back(emitter(5.f));
    const RenderConfig config{.width = 8, .height = 8, .spp = 4096, .max_depth = 2};
    const double both = mean(render_by_own_kernels(scene, config)).x;
    EXPECT_NEAR(mean(render_by_techniques(1, scene, config)).x / both, 1, 0.03);
    EXPECT_NEAR(mean(render_by_techniques(2, scene, config)).x / both, 1, 0.03);
}

TEST(NestedMedia, AbsorbTheLightOfLightsWithin) {
    Scene scene = seen_from_above(lambert(0.5f), -0.5f);
    scene.lights.resize(1);
    scene.lights[0].position = {0.4f, 0.3f, 0.f}, scene.lights[0].intensity = glm::vec3(3.f);
    add_body(scene, glm::vec3(-1.f), glm::vec3(1.f), 1.33f, 0.4f);
    const glm::dvec3 way = glm::dvec3(0.4, 0.3, 0) - glm::dvec3(0.013, -0.5, 0.017);
    const double distance = glm::length(way), arriving = 3 * way.y / std::pow(distance, 3);
    const double expected =
        arriving * 0.5 / std::numbers::pi * std::pow(0.4, distance + 1.5) * (1 - reflected(1, 1.33)) / (1.33 * 1.33);
    EXPECT_NEAR(seen(scene, 2) / expected, 1, 0.02);
    scene.lights[0].intensity /= 64.f;
    scene.lights.resize(64, scene.lights[0]);
    EXPECT_TRUE(effects_of(scene).contains({Effect::light_lists}));
    EXPECT_NEAR(seen(scene, 2) / expected, 1, 0.02);
}

/// Liquid that touches the glass or reaches into it has one border with it: the glass's, which does not tint.
TEST(NestedMedia, TouchAndOverlapAlike) {
    const double expected = 0.5 * passed({1.33, 1.5, 1.0});
    for (const float bottom : {0.f, -0.3f}) {
        Scene scene = seen_from_above(emitter(1.f), -3.f);
        scene.materials[0].albedo = glm::vec3(0.f);
        add_body(scene, {-1.f, -1.f, -1.f}, {1.f, 0.f, 1.f}, 1.5f);
        add_body(scene, {-1.f, bottom, -1.f}, {1.f, 1.f, 1.f}, 1.33f);
        scene.materials[2].albedo = glm::vec3(0.5f);
        EXPECT_EQ(nested_media(scene), (std::vector<std::uint32_t>{2, 1})) << "glass displaces water";
        EXPECT_NEAR(seen(scene), expected, 0.003) << bottom;
        for (glm::uvec3& t : scene.meshes[2].triangles) t = {t.y, t.z, t.x};
        std::reverse(scene.meshes[2].triangles.begin(), scene.meshes[2].triangles.end());
        EXPECT_NEAR(seen(scene), expected, 0.003) << "in another order";
    }
}

/// A body within another one is there, though its index be lower; one of the same index is not visible.
TEST(NestedMedia, WithinOthersDisplaceThem) {
    for (const float ior : {1.f, 1.6f, 2.4f}) {
        Scene scene = seen_from_above(emitter(1.f), -3.f);
        scene.materials[0].albedo = glm::vec3(0.f);
        add_body(scene, glm::vec3(-0.5f), glm::vec3(0.5f), ior);
        add_body(scene, glm::vec3(-1.f), glm::vec3(1.f), 1.6f);
        EXPECT_EQ(nested_media(scene), (std::vector<std::uint32_t>{2, 1})) << ior;
        EXPECT_NEAR(seen(scene), passed({1.6, double(ior), 1.6, 1.0}), 0.004) << ior;
    }
}

/// Without an inside there is no medium, and without anything within no ray need know it.
TEST(NestedMedia, AreClosedAndOccupied) {
    Scene scene = seen_from_above(lambert(0.5f), -1.f);
    add_body(scene, {-0.5f, -1.f, -0.5f}, {0.5f, 1.f, 0.5f}, 1.5f);
    EXPECT_TRUE(nested_media(scene).empty()) << "it stands on the square";
    scene.lights.resize(1), scene.lights[0].position = {0.f, 0.f, 0.f};
    EXPECT_EQ(nested_media(scene), std::vector<std::uint32_t>{1});
    EXPECT_FALSE(part_of(Effect::nested_media).prepare(scene).has_value());
    scene.meshes[1].positions.push_back(scene.meshes[1].positions[0] + glm::vec3(3e-7f));
    scene.meshes[1].triangles[0].x = 8;
    EXPECT_EQ(nested_media(scene), std::vector<std::uint32_t>{1}) << "a corner is rounded twice";
    scene.instances = {{.mesh = 0}, {.mesh = 1}};
    scene.instances[1].transform[3].x = 5.f;
    EXPECT_TRUE(nested_media(scene).empty()) << "moved away from the light";
    scene.instances.clear();
    scene.meshes[1].triangles.pop_back(), scene.meshes[1].materials.pop_back();
    EXPECT_TRUE(nested_media(scene).empty()) << "open";
}

}  // namespace
}  // namespace claray::test
