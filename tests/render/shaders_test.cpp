// A kernel for each kind of material: which there are, and that they change no bit of an image
// (render/queues/sort_hits.cl).
#include <gtest/gtest.h>

#include <algorithm>

#include "claray/shared/path.h"
#include "host/compute/device_state.hpp"
#include "host/effects/effects.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

const RenderConfig small = {.width = 40, .height = 30, .spp = 8, .max_depth = 5};

/// A device whose kernels are split for scenes with so many effects of materials; 0: never.
Device device_that_splits(unsigned from) {
    Device fresh = Device::open(std::to_string(device().info().index));
    fresh.set_tuning("render/shade_surface", "SPLIT_FROM", from);
    return fresh;
}

/// Balls on a floor under a lamp and a sky.
Scene balls_of(const std::vector<Material>& materials) {
    Scene scene;
    scene.materials = {lambert(0.6f), emitter(3.f)};
    scene.meshes = {square(4.f, -1.f), square(1.f, 3.f, 1)};
    for (std::size_t i = 0; i < materials.size(); ++i) {
        Mesh ball = sphere(2);
        for (glm::vec3& p : ball.positions) p = 0.6f * p + glm::vec3(1.3f * float(i) - 1.3f, -0.4f, 0.f);
        ball.materials.assign(ball.triangles.size(), std::uint32_t(scene.materials.size()));
        scene.materials.push_back(materials[i]);
        scene.meshes.push_back(ball);
    }
    scene.sky = {glm::vec3(0.1f), glm::vec3(0.3f)};
    scene.camera = Camera{{0.5f, 2, 6}, {0, 0, 0}, {0, 1, 0}, 45.f};
    return scene;
}

Material layered(unsigned layers) {
    Material m = material(MaterialKind::principled, 0.5f, 0.4f);
    if ((layers & 1) != 0) m.sheen = glm::vec3(0.5f);
    if ((layers & 2) != 0) m.clearcoat = 0.5f;
    if ((layers & 4) != 0) m.iridescence = 1.f, m.film_thickness.y = 400.f;
    if ((layers & 8) != 0) m.specular_weight = 0.5f;
    return m;
}

TEST(Shaders, AreTheDifferentKindsOfMaterialsInUse) {
    Scene scene = balls_of({material(MaterialKind::metal, 0.9f, 0.3f), lambert(0.2f), layered(1), layered(1)});
    scene.materials.push_back(material(MaterialKind::mirror, 1.f));  // on no surface
    const std::vector<EffectSet> shaders = shaders_of(scene);
    const std::vector<EffectSet> expected = {{Effect::lambert}, {Effect::metal}, {Effect::principled, Effect::sheen}};
    EXPECT_EQ(shaders, expected);
    EXPECT_EQ(shader_of(scene.materials[0], shaders), 0u);
    EXPECT_EQ(shader_of(scene.materials[4], shaders), 2u);
    EXPECT_FALSE(shader_of(scene.materials.back(), shaders));
}

TEST(Shaders, OfManyKindsAreJoined) {
    std::vector<Material> materials = {material(MaterialKind::metal, 0.9f, 0.3f)};
    for (unsigned layers = 0; layers < 16; ++layers) materials.push_back(layered(layers));
    const Scene scene = balls_of(materials);
    const std::vector<EffectSet> shaders = shaders_of(scene);
    EXPECT_EQ(shaders.size(), CLARAY_MOST_SHADERS);
    for (const Material& m : scene.materials) {
        const auto number = shader_of(m, shaders);
        ASSERT_TRUE(number);
        EXPECT_TRUE(shaders[*number].contains(effects_of_bsdf(m)));
    }
}

TEST(Shaders, ChangeNoBitOfTheImage) {
    const Device split = device_that_splits(1), whole = device_that_splits(0);
    Scene scene = balls_of({material(MaterialKind::glass, 1.f, 0.4f), layered(8)});
    for (const bool instanced : {false, true}) {
        if (instanced)
            for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) scene.instances.push_back({i});
        Renderer by_kind(split, scene, small), at_once(whole, scene, small);
        by_kind.render(), at_once.render();
        EXPECT_TRUE(same_bits(by_kind.image(), at_once.image())) << "instanced: " << instanced;
        EXPECT_EQ(by_kind.statistics().bounce.rays, at_once.statistics().bounce.rays);
        EXPECT_EQ(by_kind.statistics().shadow.rays, at_once.statistics().shadow.rays);
    }
}

/// To a kind that has a kernel, and to one that has none.
TEST(Shaders, FollowChangedMaterials) {
    const Device split = device_that_splits(1);
    Scene scene = balls_of({material(MaterialKind::metal, 0.9f, 0.3f)});
    Renderer renderer(split, scene, small);
    for (const Material& next : {lambert(0.3f), material(MaterialKind::mirror, 0.8f)}) {
        renderer.render();
        scene.materials[2] = next;
        renderer.update(scene, {.materials = true});
        renderer.render();
        Renderer fresh(split, scene, small);
        fresh.render();
        EXPECT_TRUE(same_bits(renderer.image(), fresh.image()));
    }
}

TEST(Shaders, OfASecondSceneAreThoseOfTheFirst) {
    const Device split = device_that_splits(1);
    const Material metal = material(MaterialKind::metal, 0.9f, 0.3f), mirror = material(MaterialKind::mirror, 0.8f);
    const auto programs_after = [&](const Material& last) {
        Renderer renderer(split, balls_of({metal, mirror, last}), small);
        renderer.render();
        return state_of(split).programs.size();
    };
    const std::size_t first = programs_after(material(MaterialKind::unlit, 0.5f));
    EXPECT_EQ(programs_after(material(MaterialKind::oren_nayar, 0.5f, 0.5f)), first + 1);
}

}  // namespace
}  // namespace claray::test
