// Layers of a render's light: kernels/render/layers/light_layers.clh, render/layers/add_light_layers.cl,
// render/layers/accumulate_layers.cl and host/render/layers/light_layers.cpp.
#include "host/render/layers/light_layers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "host/render/kernels/kernel_choice.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using Layers = std::map<std::string, std::vector<glm::vec3>>;

Layers light_layers_by_name(const Renderer& renderer) {
    Layers layers;
    for (const LightLayer& layer : renderer.light_layers()) layers[layer.name] = layer.pixels;
    return layers;
}

/// Tests that the layers whose names begin so are the image, and that their rest is rounding. Returns its largest
/// share.
double largest_rest(const Layers& layers, const std::string& prefix, const std::vector<glm::vec3>& image) {
    double largest = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        glm::dvec3 sum(0), lobes(0), size(0);
        for (const auto& [name, pixels] : layers) {
            if (!name.starts_with(prefix)) continue;
            sum += glm::dvec3(pixels[i]), size += glm::abs(glm::dvec3(pixels[i]));
            if (name != prefix + "rest") lobes += glm::dvec3(pixels[i]);
        }
        for (int c = 0; c < 3; ++c) {
            const double scale = std::max(double(image[i][c]), 1e-3);
            EXPECT_NEAR(sum[c], double(image[i][c]), 1e-6 * scale) << prefix << ' ' << i;
            largest = std::max(largest, std::abs(lobes[c] - double(image[i][c])) / std::max(size[c], 1e-3));
        }
    }
    return largest;
}

RenderConfig layered_config(unsigned spp = 16) { return {.width = 24, .height = 16, .spp = spp}; }

RenderConfig with_lobes(RenderConfig config = layered_config()) {
    config.lobes = true;
    return config;
}

/// Every kind of light, surface and map: the image has the same bits as without layers, and they add up to it.
class LightLayersOfScenes : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, LightLayersOfScenes,
                         testing::Values("cornell", "effects", "effect:fog", "effect:absorption", "effect:nested-media",
                                         "effect:hot-spots", "effect:light-lists", "effect:many-lights",
                                         "effect:sun-lights", "effect:environment", "effect:instances",
                                         "effect:instance-motion", "effect:primitives", "effect:blinn-phong",
                                         "effect:sheen", "effect:layered-coat", "effect:thin-walls",
                                         "effect:light-maps", "effect:unlit", "effect:oren-nayar"));

TEST_P(LightLayersOfScenes, AddUpToTheImage) {
    const std::optional<Scene> scene = builtin_scene(GetParam());
    ASSERT_TRUE(scene);
    Renderer plain(device(), *scene, layered_config());
    plain.render();
    RenderConfig config = with_lobes();
    config.light_groups = {"first=" + std::string(scene->lights.empty() ? "sky" : "light:0")};
    Renderer split(device(), *scene, config);
    split.render();
    const std::vector<glm::vec3> image = split.image();
    EXPECT_EQ(image, plain.image());
    const Layers layers = light_layers_by_name(split);
    EXPECT_EQ(layers.size(), CLARAY_LOBE_COUNT + 1 + 2);
    EXPECT_LT(largest_rest(layers, "lobe_", image), 2e-6);
    (void)largest_rest(layers, "light_", image);
}

/// A group's layer is the image of its lights alone.
TEST(LightLayers, OfAGroupAreTheImageOfItsLights) {
    Scene scene;
    scene.materials = {lambert(0.5f), emitter(4.f), emitter(9.f)};
    scene.materials[1].name = "left", scene.materials[2].name = "right";
    scene.meshes = {square(3.f, 0.f), square(0.3f, 2.f, 1), square(0.3f, 2.f, 2)};
    for (glm::vec3& p : scene.meshes[1].positions) p.x -= 1.5f;
    for (glm::vec3& p : scene.meshes[2].positions) p.x += 1.5f;
    scene.lights = {point_light({0, 2, 2}, {3, 2, 1}), point_light({0, 1, -2}, {1, 2, 3})};
    scene.lights[0].name = "warm";
    scene.sky.horizon = scene.sky.zenith = glm::vec3(0.2f);
    scene.camera = Camera{{0, 5, 6}, {0, 0, 0}, {0, 1, 0}, 40.f};
    RenderConfig config{.width = 16, .height = 12, .spp = 4096};
    config.light_groups = {"key=left,warm", "air=sky"};
    Renderer renderer(device(), scene, config);
    renderer.render();
    Layers layers = light_layers_by_name(renderer);
    const auto mean_of = [&](Scene alone) {
        Renderer other(device(), alone, {.width = 16, .height = 12, .spp = 4096});
        other.render();
        return mean(other.image());
    };
    Scene key = scene, air = scene, rest = scene;
    key.lights.pop_back(), key.materials[2].emission = glm::vec3(0), key.sky = {};
    air.lights.clear(), air.materials[1].emission = air.materials[2].emission = glm::vec3(0);
    rest.lights.erase(rest.lights.begin()), rest.materials[1].emission = glm::vec3(0), rest.sky = {};
    for (const auto& [name, alone] :
         {std::pair("light_key", key), std::pair("light_air", air), std::pair("light_rest", rest)}) {
        const glm::vec3 layer = mean(layers.at(name)), image = mean_of(alone);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(layer[c] / image[c], 1, 0.01) << name << ' ' << c;
    }
}

/// A white floor under a white sky: all light is direct and diffuse. A mirror's is glossy; glass in front of the sky
/// transmits.
TEST(LightLayers, TellTheLobes) {
    const auto lobes_of = [](const Material& material, unsigned depth) {
        Scene scene;
        scene.materials = {material};
        scene.meshes = {square(50.f, 0.f)};
        scene.sky.horizon = scene.sky.zenith = glm::vec3(1);
        scene.camera = narrow_camera({0, 3, 1}, {0, 0, 0});
        RenderConfig config{.width = 2, .height = 2, .spp = 1024, .max_depth = depth};
        config.lobes = true;
        Renderer renderer(device(), scene, config);
        renderer.render();
        std::map<std::string, float> means;
        for (const auto& [name, pixels] : light_layers_by_name(renderer)) means[name] = mean(pixels).x;
        return means;
    };
    const auto diffuse = lobes_of(lambert(0.6f), 4);
    EXPECT_NEAR(diffuse.at("lobe_diffuse_direct"), 0.6f, 0.01f);
    EXPECT_EQ(diffuse.at("lobe_glossy_direct"), 0.f);
    const auto mirror = lobes_of(material(MaterialKind::mirror, 0.6f), 4);
    EXPECT_NEAR(mirror.at("lobe_glossy_direct"), 0.6f, 0.01f);
    EXPECT_EQ(mirror.at("lobe_diffuse_direct"), 0.f);
    const auto glass = lobes_of(material(MaterialKind::glass, 1.f, 0.f), 4);
    EXPECT_NEAR(glass.at("lobe_glossy_direct") + glass.at("lobe_transmission_direct"), 1.f, 0.02f);
    EXPECT_GT(glass.at("lobe_transmission_direct"), 0.9f);
    // A dielectric over a black base only mirrors; over a coloured one the glossy part stays the same.
    Material plastic = material(MaterialKind::principled, 0.f, 0.4f);
    const auto black = lobes_of(plastic, 4);
    plastic.albedo = glm::vec3(0.8f);
    const auto white = lobes_of(plastic, 4);
    EXPECT_NEAR(white.at("lobe_glossy_direct"), black.at("lobe_glossy_direct"), 0.003f);
    EXPECT_GT(white.at("lobe_diffuse_direct"), 0.6f);
    EXPECT_EQ(black.at("lobe_diffuse_direct"), 0.f);
    Material lamp = emitter(3.f);
    EXPECT_NEAR(lobes_of(lamp, 1).at("lobe_emission"), 3.f, 1e-5f);
}

/// Direct light is that of paths that one surface scatters; all other light is indirect.
TEST(LightLayers, TellDirectFromIndirectLight) {
    Scene scene = *builtin_scene("cornell");
    RenderConfig config = with_lobes(layered_config(256));
    Renderer all(device(), scene, config);
    all.render();
    config.max_depth = 1, config.lobes = false;
    Renderer direct(device(), scene, config);
    direct.render();
    const Layers layers = light_layers_by_name(all);
    const glm::vec3 of_lobes = mean(layers.at("lobe_diffuse_direct")) + mean(layers.at("lobe_glossy_direct")) +
                               mean(layers.at("lobe_emission")) + mean(layers.at("lobe_environment"));
    const glm::vec3 of_image = mean(direct.image());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(of_lobes[c] / of_image[c], 1, 0.02);
    const glm::vec3 indirect = mean(layers.at("lobe_diffuse_indirect")),
                    others = glm::vec3(mean(all.image())) - of_image;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(indirect[c] / others[c], 1, 0.05);
}

TEST(LightLayers, AreClampedAndDroppedWithTheirSamples) {
    const Scene scene = *builtin_scene("cornell");
    RenderConfig config = with_lobes(layered_config(64));
    config.sample_clamp = 0.5f;
    Renderer renderer(device(), scene, config);
    renderer.render();
    EXPECT_LT(largest_rest(light_layers_by_name(renderer), "lobe_", renderer.image()), 2e-6);
}

TEST(LightLayers, OfAdaptiveAndGuidedRendersAddUp) {
    const Scene scene = *builtin_scene("cornell");
    RenderConfig config = with_lobes({.width = 160, .height = 120, .spp = 40});
    config.adaptive = true;
    Renderer renderer(device(), scene, config);
    renderer.render();
    EXPECT_LT(largest_rest(light_layers_by_name(renderer), "lobe_", renderer.image()), 2e-6);
    config.lobes = false;
    Renderer plain(device(), scene, config);
    plain.render();
    EXPECT_EQ(renderer.image(), plain.image());
}

TEST(LightLayers, FollowChanges) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(3.f, 0.f)};
    scene.lights = {point_light({0, 2, 0}, {1, 1, 1})};
    scene.lights[0].name = "a";
    scene.camera = Camera{{0, 5, 6}, {0, 0, 0}, {0, 1, 0}, 40.f};
    RenderConfig config = layered_config(8);
    config.light_groups = {"a=a"};
    Renderer renderer(device(), scene, config);
    renderer.render();
    Light other = point_light({1, 2, 0}, {5, 5, 5});
    other.name = "b";
    scene.lights.insert(scene.lights.begin(), other);
    renderer.update(scene, {.lights = true});
    renderer.render();
    Renderer fresh(device(), scene, config);
    fresh.render();
    EXPECT_EQ(light_layers_by_name(renderer).at("light_a"), light_layers_by_name(fresh).at("light_a"));
    renderer.resize(12, 10);
    renderer.render();
    EXPECT_EQ(light_layers_by_name(renderer).at("light_a").size(), 120u);
}

TEST(LightLayers, RefuseWhatTheyDoNotKnow) {
    Scene scene = *builtin_scene("cornell");
    const auto refuses = [&](const char* what, const RenderConfig& config) {
        EXPECT_TRUE(throws_error(ErrorKind::usage, what, [&] { (void)Renderer(device(), scene, config); })) << what;
    };
    const auto groups = [](const std::vector<std::string>& texts) {
        RenderConfig config = layered_config();
        config.light_groups = texts;
        return config;
    };
    refuses("there is no light 'lamp'", groups({"key=lamp"}));
    refuses("is in a group already", groups({"a=sky", "b=sky"}));
    refuses("given twice", groups({"a=sky", "a=material:0"}));
    refuses("no name of a group", groups({"rest=sky"}));
    refuses("has no lights", groups({"key"}));
    RenderConfig config = with_lobes();
    config.approximate.no_shadows = true;
    refuses("approximations", config);
    config = with_lobes(), config.checkpoint = "a.checkpoint";
    refuses("checkpoint", config);
    config = with_lobes(), config.alpha = true;
    refuses("alpha", config);
    const Renderer plain(device(), scene, layered_config());
    EXPECT_TRUE(throws_error(ErrorKind::usage, "keeps no layers", [&] { (void)plain.light_layers(); }));
}

/// Kernels of renders without layers are those that they were: no macro is added, and no program.
TEST(LightLayers, AddNothingToOtherRenders) {
    const SceneTraits scene = traits_of(*builtin_scene("effects"));
    const KernelSet plain = scene_kernels(device(), scene, layered_config()).programs;
    for (const ProgramRequest& program : plain.programs()) {
        EXPECT_EQ(program.file.find("layers"), std::string::npos);
        for (const auto& [name, value] : program.defines) EXPECT_NE(name, "LIGHT_LAYERS");
    }
    EXPECT_FALSE(scene_kernels(device(), scene, with_lobes()).programs == plain);
}

}  // namespace
}  // namespace claray::test
