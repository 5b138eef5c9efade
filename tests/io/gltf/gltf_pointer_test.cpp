// glTF: what animations move by pointers (KHR_animation_pointer), and nodes that are not shown (KHR_node_visibility).
#include <cmath>

#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray::test {
namespace {

class GltfPointers : public GltfTest {
protected:
    GltfPointers() {
        builder.push("materials", {{"pbrMetallicRoughness", json::object()}, {"emissiveFactor", {1, 1, 1}}});
        builder.triangle({{"material", 0}});
    }

    /// An animation from 0 to 2 s of what the pointer names.
    template <class T>
    void animate(const std::string& pointer, const char* type, const std::vector<T>& values,
                 const char* interpolation = "LINEAR") {
        const json target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
        json& animations = builder.root["animations"];
        if (animations.is_null())
            builder.push("animations", {{"channels", json::array()}, {"samplers", json::array()}});
        json& animation = builder.root["animations"][0];
        animation["channels"].push_back({{"sampler", animation["samplers"].size()}, {"target", target}});
        animation["samplers"].push_back({{"input", builder.accessor<float>("SCALAR", {0, 2})},
                                         {"output", builder.accessor<T>(type, values)},
                                         {"interpolation", interpolation}});
    }
    Scene at(double time) { return load({.time = time}); }
};

TEST_F(GltfPointers, MoveFactorsOfMaterials) {
    animate<float>("/materials/0/pbrMetallicRoughness/baseColorFactor", "VEC4", {0, 0.5f, 1, 1, 1, 0.5f, 0, 0});
    animate<float>("/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR", {1, 0});
    animate<float>("/materials/0/emissiveFactor", "VEC3", {0, 0, 0, 2, 4, 6});
    const Material material = at(0.5).materials.at(0);
    EXPECT_EQ(material.albedo, glm::vec3(0.25f, 0.5f, 0.75f));
    EXPECT_EQ(material.opacity, 0.75f);
    EXPECT_EQ(material.roughness, 0.75f);
    EXPECT_EQ(material.emission, glm::vec3(0.5f, 1.f, 1.5f));
    EXPECT_EQ(warned("left out"), 0u);
    EXPECT_EQ(load().materials.at(0).roughness, 1.f) << "at rest";
}

TEST_F(GltfPointers, MoveExtensionsOfMaterials) {
    json& extensions = builder.root["materials"][0]["extensions"];
    extensions["KHR_materials_ior"] = {{"ior", 1.5}};
    extensions["KHR_materials_emissive_strength"] = json::object();
    animate<float>("/materials/0/extensions/KHR_materials_ior/ior", "SCALAR", {1, 2});
    animate<float>("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength", "SCALAR", {0, 8});
    const Material material = at(1).materials.at(0);
    EXPECT_EQ(material.ior, 1.5f);
    EXPECT_EQ(at(2).materials.at(0).ior, 2.f);
    EXPECT_EQ(material.emission, glm::vec3(4.f));
}

TEST_F(GltfPointers, MoveTexturesOverSurfaces) {
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {
        {"index", builder.texture("missing.png")}, {"extensions", {{"KHR_texture_transform", json::object()}}}};
    animate<float>("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/offset", "VEC2",
                   {0, 0, 1, 3});
    const Scene scene = load({.time = 0.5, .images = false});
    EXPECT_EQ(scene.materials.at(0).albedo_map.offset, glm::vec2(0.25f, 0.75f));
}

TEST_F(GltfPointers, MoveCamerasAndLights) {
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    builder.push("nodes", {{"camera", 0}});
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", json::object()}}};
    builder.push("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    animate<float>("/cameras/0/perspective/yfov", "SCALAR", {0.5f, 1.5f});
    animate<float>("/extensions/KHR_lights_punctual/lights/0/intensity", "SCALAR", {2, 4});
    animate<float>("/extensions/KHR_lights_punctual/lights/0/color", "VEC3", {1, 1, 1, 0, 1, 0.5f});
    animate<float>("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", "SCALAR", {0.5f, 0.7f});
    const Scene scene = at(1);
    EXPECT_NEAR(scene.camera->vertical_fov, glm::degrees(1.f), 1e-4f);
    EXPECT_EQ(scene.lights.at(0).intensity, glm::vec3(1.5f, 3.f, 2.25f));
    EXPECT_NEAR(scene.lights.at(0).outer_angle, 0.6f, 1e-6f);
}

/// The same as the channel of a node: rotations are spherical.
TEST_F(GltfPointers, MoveNodes) {
    const float half = std::sqrt(0.5f);
    animate<float>("/nodes/0/rotation", "VEC4", {0, 0, 0, 1, 0, 0, half, half});
    animate<float>("/nodes/0/translation", "VEC3", {0, 0, 0, 2, 0, 0});
    const double angle = std::acos(-1.0) / 6;
    const Scene scene = at(2.0 / 3);
    expect_near(scene.meshes.at(0).positions[1], {float(2.0 / 3 + std::cos(angle)), float(std::sin(angle)), 0});
    EXPECT_EQ(warned("left out"), 0u);
}

TEST_F(GltfPointers, ThoseToNothingAreLeftOut) {
    for (const char* pointer :
         {"/materials/7/emissiveFactor", "/materials/0/extensions/KHR_materials_ior/ior", "/materials/01/alphaCutoff",
          "/nodes/0/mesh", "/accessors/0/count", "/asset/version", "nodes/0/scale", "/nodes/x/scale", "/", "",
          "/materials/0/emissiveFactor/x", "/cameras/0/perspective/yfov"})
        animate<float>(pointer, "SCALAR", {0, 1});
    const Scene scene = at(1);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(warned("12 channels animate unsupported properties: they are left out"), 1u);
    animate<float>("/materials/0/emissiveFactor", "SCALAR", {0, 1});  // of three numbers
    at(1);
    EXPECT_EQ(warned("13 channels"), 1u);
}

TEST_F(GltfPointers, BadKeysAreNamed) {
    animate<float>("/materials/0/alphaCutoff", "SCALAR", {0, INFINITY});
    refuse({"channel of '/materials/0/alphaCutoff': its value at 2 s is not finite"}, {.time = 2});
    builder.root["animations"][0]["channels"][0]["sampler"] = 4;
    refuse({"channel of '/materials/0/alphaCutoff' refers to sampler 4 of 1"}, {.time = 2});
    builder.root["animations"][0]["channels"][0]["sampler"] = 0;
    builder.root["animations"][0]["samplers"][0]["output"] = 99;
    refuse({"its values refers to accessor 99 of"}, {.time = 2});
}

class GltfVisibility : public GltfTest {
protected:
    GltfVisibility() {
        const int mesh = builder.triangle();
        builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
        builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
        builder.root["nodes"] = {{{"mesh", mesh}},
                                 {{"children", {2, 3, 4}}},
                                 {{"mesh", mesh},
                                  {"translation", {5, 0, 0}},
                                  {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}},
                                 {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                                 {{"camera", 0}}};
        builder.root["scenes"] = {{{"nodes", {0, 1}}}};
    }
    void show(int node, bool visible) {
        builder.root["nodes"][node]["extensions"]["KHR_node_visibility"] = {{"visible", visible}};
    }
};

TEST_F(GltfVisibility, HidesMeshesAndLightsBelowButNoCamera) {
    const Scene all = load();
    EXPECT_EQ(all.instances.size(), 2u);
    EXPECT_EQ(all.lights.size(), 1u);
    show(1, false);
    const Scene scene = load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 0u);
    EXPECT_EQ(scene.meshes[0].positions.at(0).x, 0.f);
    EXPECT_TRUE(scene.lights.empty());
    EXPECT_TRUE(scene.camera);
    show(0, false);
    refuse({"it contains no triangle"});
}

/// An empty frame of an animation is no error.
TEST_F(GltfVisibility, IsAnimated) {
    for (const int node : {0, 1}) {
        show(node, true);
        const json target = {
            {"path", "pointer"},
            {"extensions",
             {{"KHR_animation_pointer",
               {{"pointer", "/nodes/" + std::to_string(node) + "/extensions/KHR_node_visibility/visible"}}}}}};
        builder.push("animations", {{"channels", {{{"sampler", 0}, {"target", target}}}},
                                    {"samplers",
                                     {{{"input", builder.accessor<float>("SCALAR", {0, 1})},
                                       {"output", builder.accessor<std::uint8_t>("SCALAR", {1, 0})},
                                       {"interpolation", "STEP"}}}}});
    }
    EXPECT_EQ(load({.time = 0.5, .animation = "all"}).lights.size(), 1u);
    const Scene hidden = load({.time = 1, .animation = "all"});
    EXPECT_TRUE(hidden.lights.empty());
    for (const MeshInstance& instance : hidden.instances)
        for (const glm::vec3& p : hidden.meshes.at(instance.mesh).positions) EXPECT_EQ(p, glm::vec3(0.f));
}

}  // namespace
}  // namespace claray::test
