// Files that would be dark are lit, and others stay as they are.
#include "host/io/default_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "claray/error.hpp"
#include "tests/io/gltf/gltf_builder.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

/// A ball-like thing (an octahedron of radius 1) on a floor, before a camera of the file.
class DefaultLight : public testing::Test {
protected:
    DefaultLight() {
        add({1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1},
            {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5});
        add({-4, -1, 4, 4, -1, 4, 4, -1, -4, -4, -1, -4}, {0, 1, 2, 0, 2, 3});
        builder.push("materials", {{"name", "thing"}, {"doubleSided", true}});
        look_from(8);
    }
    void add(const std::vector<float>& positions, const std::vector<std::uint16_t>& indices, int material = 0) {
        const json primitive = {{"attributes", {{"POSITION", builder.accessor<float>("VEC3", positions)}}},
                                {"indices", builder.accessor<std::uint16_t>("SCALAR", indices)},
                                {"material", material}};
        builder.push("nodes", {{"mesh", builder.push("meshes", {{"primitives", {primitive}}})}});
    }
    void look_from(float z) {
        builder.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}}};
        builder.push("nodes", {{"camera", 0}, {"translation", {0, 0, z}}});
    }
    /// A cube of half the side `r` round the origin, seen from inside as from outside.
    void add_box(float r) {
        std::vector<float> corners;
        for (int i = 0; i < 8; ++i)
            for (int k = 0; k < 3; ++k) corners.push_back(i >> k & 1 ? r : -r);
        add(corners, {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                      2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5});
    }
    void add_light(const char* type, float intensity, const std::vector<float>& translation, float range = 0) {
        json light = {{"type", type}, {"intensity", intensity}};
        if (range > 0) light["range"] = range;
        json& lights = builder.root["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(light);
        builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
        builder.push("nodes", {{"translation", translation},
                               {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}});
    }
    /// By an image of 64x64 pixels of which the first ones are white.
    void write_emission(unsigned white) const {
        Image image{64, 64, std::vector<glm::vec3>(64 * 64)};
        std::fill_n(image.pixels.begin(), white, glm::vec3(1.f));
        write_image(folder / "emission.png", image, 0, ToneMap::none);
    }
    void emit(unsigned white) {
        write_emission(white);
        json& material = builder.root["materials"][0];
        material["emissiveFactor"] = {1, 1, 1};
        material["emissiveTexture"]["index"] = builder.texture("emission.png");
        for (json& mesh : builder.root["meshes"]) {
            json& attributes = mesh["primitives"][0]["attributes"];
            const bool ball = builder.root["accessors"][attributes["POSITION"].get<std::size_t>()]["count"] == 6;
            std::vector<float> uvs = {0, 0, 1, 0, 1, 1, 0, 1};
            if (ball) uvs.insert(uvs.end(), {.5f, .5f, .5f, .2f});
            attributes["TEXCOORD_0"] = builder.accessor<float>("VEC2", uvs);
        }
    }
    Scene load() { return load_gltf(folder.file("scene.gltf", builder.gltf()), warnings); }
    void expect_sky(const std::string& reason) {
        const std::size_t lights = builder.root.contains("extensions") ? 1 : 0;
        const Scene scene = load();
        EXPECT_GT(scene.sky.zenith.y, 0.f);
        EXPECT_EQ(scene.lights.size(), lights);
        ASSERT_EQ(warnings.size(), 1u);
        EXPECT_EQ(warnings[0], reason + ": added a pale sky as light");
    }
    void expect_as_it_is() {
        const std::size_t lights = builder.root.contains("extensions") ? 1 : 0;
        const Scene scene = load();
        EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f));
        EXPECT_EQ(scene.lights.size(), lights);
        EXPECT_TRUE(warnings.empty());
    }

    TemporaryFolder folder;
    GltfBuilder builder;
    Warnings warnings;
};

constexpr const char* out_of_reach = "no light of the file reaches the visible surfaces";

TEST_F(DefaultLight, WithoutAnyLight) { expect_sky("the file has no light"); }

TEST_F(DefaultLight, AnEmissiveFactorIsNoLightWhereItsImageIsBlack) {
    emit(0);
    expect_sky("the file has no light");
}

TEST_F(DefaultLight, NorAreAFewBrightPixels) {
    emit(3);
    static_cast<void>(load());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("a pale sky"), std::string::npos);
}

TEST_F(DefaultLight, WhatShinesAllOverStaysAsItIs) {
    emit(64 * 64);
    expect_as_it_is();
}

TEST_F(DefaultLight, ALampThatLightsTheSceneIsEnough) {
    builder.push("materials", {{"emissiveFactor", {1, 1, 1}}});
    add({-2, 4, 2, 2, 4, 2, 2, 4, -2, -2, 4, -2}, {0, 2, 1, 0, 3, 2}, 1);
    expect_as_it_is();
}

TEST_F(DefaultLight, ACandleIsNot) {
    builder.push("materials", {{"emissiveFactor", {1, 1, 1}}});
    add({-.02f, 2, .02f, .02f, 2, .02f, .02f, 2, -.02f}, {0, 1, 2}, 1);
    expect_sky(out_of_reach);
}

TEST_F(DefaultLight, LightsThatReachTheSceneStayAlone) {
    add_light("point", 30, {0, 3, 3});
    expect_as_it_is();
}

/// Points and lines are primitives, which rays of the host do not meet.
TEST_F(DefaultLight, LightsThatReachPointsAndLinesStayAlone) {
    builder.root["nodes"] = json::array(), builder.root["meshes"] = json::array();
    for (const int mode : {0, 3}) {
        add({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f}, {0, 1, 2, 3});
        builder.root["meshes"].back()["primitives"][0]["mode"] = mode;
    }
    EXPECT_GT(load().sky.zenith.y, 0.f);
    EXPECT_EQ(warnings[warnings.size() - 1], "the file has no light: added a pale sky as light");
    add_light("point", 30, {0, 3, 6});
    const Scene scene = load();
    EXPECT_EQ(scene.primitives.size(), 3u);
    EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f)) << warnings[warnings.size() - 1];
}

TEST_F(DefaultLight, ASunStaysAlone) {
    add_light("directional", 3, {0, 0, 0});
    expect_as_it_is();
}

TEST_F(DefaultLight, AWeakSunDoesNot) {
    add_light("directional", 1e-3f, {0, 0, 0});
    expect_sky(out_of_reach);
}

TEST_F(DefaultLight, NorALampOutOfRange) {
    add_light("point", 30, {0, 3, 3}, 0.5f);
    expect_sky(out_of_reach);
}

TEST_F(DefaultLight, NorALampInsideAClosedThing) {
    add_light("point", 30, {0, 0, 0});
    expect_sky(out_of_reach);
}

TEST_F(DefaultLight, InAClosedRoomALampIsPutAtTheCamera) {
    add_box(10);
    const Scene scene = load();
    EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f));
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].position, glm::vec3(0, 0, 8));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0], "the file has no light, and a sky would not help: added a lamp at the camera");
}

TEST_F(DefaultLight, NotWhereTheRoomHasALamp) {
    add_box(10);
    add_light("point", 30, {0, 3, 3});
    expect_as_it_is();
}

/// Every way to load a file does the same.
TEST_F(DefaultLight, ObjAndGltfByAllFunctions) {
    static_cast<void>(folder.file("m.mtl", "newmtl m\nKe 1 1 1\nmap_Ke emission.png\n"));
    write_emission(0);
    const std::string obj =
        folder.file("a.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
    EXPECT_GT(load_obj(obj, warnings).sky.zenith.y, 0.f);
    EXPECT_GT(load_scene(obj, warnings).sky.zenith.y, 0.f);
    const std::string gltf = folder.file("scene.gltf", builder.gltf()).string();
    EXPECT_GT(load_scene(gltf, warnings).sky.zenith.y, 0.f);
    for (const std::string& warning : warnings) EXPECT_EQ(warning, "the file has no light: added a pale sky as light");
    EXPECT_EQ(warnings.size(), 3u);
    EXPECT_EQ(load_scene("effect:spot-lights", warnings).sky.zenith, builtin_scene("effect:spot-lights")->sky.zenith);
    EXPECT_EQ(warnings.size(), 3u);
}

/// A camera that can't be used is an error of whoever renders.
TEST_F(DefaultLight, ACameraThatLooksAlongItsUpVector) {
    Scene scene = load_without_light(folder.file("scene.gltf", builder.gltf()).string(), warnings, {}).scene;
    EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f));
    scene.camera->up = scene.camera->target - scene.camera->position;
    EXPECT_THROW(static_cast<void>(light_if_dark(scene, *scene.camera, 1.f)), Error);
}

}  // namespace
}  // namespace claray::test
