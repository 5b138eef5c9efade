// Files that would be dark are lit, and others stay as they are.
#include "host/io/default_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "claray/error.hpp"
#include "host/lights/studio.hpp"
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
    /// Twelve triangles whose fronts are outside or inside.
    void add_cuboid(const glm::vec3& lo, const glm::vec3& hi, bool outside, int material = 0) {
        std::vector<float> corners;
        for (int i = 0; i < 8; ++i)
            for (int k = 0; k < 3; ++k) corners.push_back(i >> k & 1 ? hi[k] : lo[k]);
        std::vector<std::uint16_t> indices = {0, 3, 1, 0, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                              2, 7, 3, 2, 6, 7, 0, 6, 2, 0, 4, 6, 1, 3, 7, 1, 7, 5};
        for (std::size_t i = 0; i < indices.size() && !outside; i += 3) std::swap(indices[i], indices[i + 1]);
        add(corners, indices, material);
    }
    /// A cube whose one-sided walls are seen from inside only.
    void add_room(float r) { add_cuboid(glm::vec3(-r), glm::vec3(r), false, 1); }
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
    void expect_studio(const std::string& reason) {
        const std::size_t lights = builder.root.contains("extensions") ? 1 : 0;
        const Scene scene = load();
        EXPECT_EQ(scene.environment.images.size(), 1u);
        EXPECT_EQ(scene.lights.size(), lights);
        ASSERT_EQ(warnings.size(), 1u);
        EXPECT_EQ(warnings[0], reason + ": added a neutral studio as light");
    }
    void expect_as_it_is() {
        const std::size_t lights = builder.root.contains("extensions") ? 1 : 0;
        const Scene scene = load();
        EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f));
        EXPECT_TRUE(scene.environment.images.empty());
        EXPECT_EQ(scene.lights.size(), lights);
        EXPECT_TRUE(warnings.empty());
    }

    TemporaryFolder folder;
    GltfBuilder builder;
    Warnings warnings;
};

constexpr const char* out_of_reach = "no light of the file reaches the visible surfaces";

TEST_F(DefaultLight, WithoutAnyLight) { expect_studio("the file has no light"); }

TEST_F(DefaultLight, AnEmissiveFactorIsNoLightWhereItsImageIsBlack) {
    emit(0);
    expect_studio("the file has no light");
}

TEST_F(DefaultLight, NorAreAFewBrightPixels) {
    emit(3);
    static_cast<void>(load());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("a neutral studio"), std::string::npos);
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
    expect_studio(out_of_reach);
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
    EXPECT_EQ(load().environment.images.size(), 1u);
    EXPECT_EQ(warnings[warnings.size() - 1], "the file has no light: added a neutral studio as light");
    add_light("point", 30, {0, 3, 6});
    const Scene scene = load();
    EXPECT_EQ(scene.primitives.size(), 3u);
    EXPECT_TRUE(scene.environment.images.empty()) << warnings[warnings.size() - 1];
}

TEST_F(DefaultLight, ASunStaysAlone) {
    add_light("directional", 3, {0, 0, 0});
    expect_as_it_is();
}

TEST_F(DefaultLight, AWeakSunDoesNot) {
    add_light("directional", 1e-3f, {0, 0, 0});
    expect_studio(out_of_reach);
}

TEST_F(DefaultLight, NorALampOutOfRange) {
    add_light("point", 30, {0, 3, 3}, 0.5f);
    expect_studio(out_of_reach);
}

TEST_F(DefaultLight, NorALampInsideAClosedThing) {
    add_light("point", 30, {0, 0, 0});
    expect_studio(out_of_reach);
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

/// The file as it is without its camera.
void drop_camera(json& root) {
    root.erase("cameras");
    for (json& node : root["nodes"]) node.erase("camera");
}

/// The floor shines, but it lights no upper side of what stands on it.
TEST_F(DefaultLight, AFloorThatShinesDoesNotLightWhatStandsOnIt) {
    builder.push("materials", {{"emissiveFactor", {0.3, 0.8, 0.8}}});
    add({-9, -1, 9, 9, -1, 9, 9, -1, -9, -9, -1, -9}, {0, 1, 2, 0, 2, 3}, 1);
    builder.root["nodes"][1].erase("mesh");  // the other floor
    drop_camera(builder.root);
    EXPECT_EQ(load().environment.images.size(), 1u);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("of the visible surfaces that do not shine: added a neutral studio"), std::string::npos)
        << warnings[0];
}

/// The camera looks through the backs of walls whose fronts keep the light of a lamp beside it out.
TEST_F(DefaultLight, ALampIsPutBehindOneSidedWalls) {
    builder.root["nodes"].erase(1), builder.root["nodes"].erase(0);
    builder.push("materials", {{"name", "wall"}});
    add_room(3);
    const Scene scene = load();
    ASSERT_EQ(scene.lights.size(), 1u);
    const glm::vec3 lamp = glm::abs(scene.lights[0].position);
    EXPECT_LT(std::max({lamp.x, lamp.y, lamp.z}), 3.f);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("a lamp behind the one-sided surfaces before the camera"), std::string::npos);
}

TEST_F(DefaultLight, AOneSidedRoomIsSeenFromInside) {
    builder.root["nodes"] = json::array();
    builder.push("materials", {{"name", "wall"}});
    add_room(3);
    const Scene scene = load();
    ASSERT_TRUE(scene.camera.has_value());
    const glm::vec3 place = glm::abs(scene.camera->position);
    EXPECT_LT(std::max({place.x, place.y, place.z}), 3.f);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].position, scene.camera->position);
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_EQ(warnings[0], "the file is mostly rooms: the view is from inside");
}

/// A hall with columns has more surface inside than outside; an empty box does not, nor does a thing in the open.
TEST_F(DefaultLight, HallsAreSeenFromInsideAndBoxesFromOutside) {
    builder.root["nodes"] = json::array();
    add_cuboid(glm::vec3(-10), glm::vec3(10), true);
    add_cuboid(glm::vec3(-9.5f), glm::vec3(9.5f), false);
    EXPECT_FALSE(load().camera.has_value());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("neutral studio"), std::string::npos) << warnings[0];
    for (float x = -7; x <= 7; x += 2.8f)
        for (float z = -7; z <= 7; z += 2.8f) add_cuboid({x - 0.3f, -9.5f, z - 0.3f}, {x + 0.3f, 9.5f, z + 0.3f}, true);
    const Scene hall = load();
    ASSERT_TRUE(hall.camera.has_value());
    EXPECT_LT(std::abs(hall.camera->position.x), 9.5f);
    EXPECT_NE(warnings[1].find("the view is from inside"), std::string::npos) << warnings[1];
}

TEST_F(DefaultLight, AFilesOwnCameraStaysWhereItIs) {
    builder.root["nodes"].erase(1), builder.root["nodes"].erase(0);
    builder.push("materials", {{"name", "wall"}});
    add_room(3);
    EXPECT_EQ(load().camera->position, glm::vec3(0, 0, 8));
}

double radiance(const Environment& studio, const glm::vec3& direction) {
    const Texture& image = studio.images.at(0);
    const glm::vec3 d = glm::normalize(direction);
    const double u = 0.5 + std::atan2(d.x, -d.z) / (2 * 3.14159265358979), v = std::acos(d.y) / 3.14159265358979;
    const auto x = std::min(unsigned(u * image.width), image.width - 1);
    const auto y = std::min(unsigned(v * image.height), image.height - 1);
    return image.floats[y * image.width + x];
}

/// Calm behind the object, bright and dark around it, and turned with the camera.
TEST(Studio, ShowsWhiteBlackAndMetal) {
    for (const glm::vec3 position : {glm::vec3(0, 0, 5), glm::vec3(5, 0, 0), glm::vec3(-3, 0, -4)}) {
        Camera camera;
        camera.position = position;
        const Environment environment = studio(camera);
        const glm::vec3 forward = glm::normalize(camera.target - camera.position);
        const glm::vec3 right = glm::normalize(glm::cross(forward, camera.up)), up = glm::cross(right, forward);
        for (float x = -0.6f; x <= 0.6f; x += 0.1f)
            for (float y = -0.36f; y <= 0.36f; y += 0.06f) {
                const double behind = radiance(environment, forward + x * right + y * up);
                EXPECT_GT(behind, 0.08);
                EXPECT_LT(behind, 0.3);
            }
        const auto& values = environment.images[0].floats;
        EXPECT_GT(*std::max_element(values.begin(), values.end()), 4.f);
        EXPECT_LT(*std::min_element(values.begin(), values.end()), 0.1f);
        double sum = 0, cosines = 0;  // of a white surface that faces the camera and slightly upwards
        const glm::vec3 normal = glm::normalize(-forward + 0.5f * camera.up);
        for (int i = 0; i < 20000; ++i) {
            const double z = 1 - 2 * (i + 0.5) / 20000, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
            const glm::vec3 d(r * std::cos(angle), z, r * std::sin(angle));
            const double cosine = std::max(glm::dot(d, normal), 0.f);
            sum += cosine * radiance(environment, d), cosines += cosine;
        }
        EXPECT_NEAR(sum / cosines, 1, 0.15);
    }
}

/// Every way to load a file does the same.
TEST_F(DefaultLight, ObjAndGltfByAllFunctions) {
    static_cast<void>(folder.file("m.mtl", "newmtl m\nKe 1 1 1\nmap_Ke emission.png\n"));
    write_emission(0);
    const std::string obj =
        folder.file("a.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
    EXPECT_EQ(load_obj(obj, warnings).environment.images.size(), 1u);
    EXPECT_EQ(load_scene(obj, warnings).environment.images.size(), 1u);
    const std::string gltf = folder.file("scene.gltf", builder.gltf()).string();
    EXPECT_EQ(load_scene(gltf, warnings).environment.images.size(), 1u);
    for (const std::string& warning : warnings)
        EXPECT_EQ(warning, "the file has no light: added a neutral studio as light");
    EXPECT_EQ(warnings.size(), 3u);
    EXPECT_EQ(load_scene("effect:spot-lights", warnings).sky.zenith, builtin_scene("effect:spot-lights")->sky.zenith);
    EXPECT_EQ(warnings.size(), 3u);
}

/// A camera that can't be used is an error of whoever renders.
TEST_F(DefaultLight, ACameraThatLooksAlongItsUpVector) {
    Scene scene = load_without_light(folder.file("scene.gltf", builder.gltf()).string(), warnings, {}).scene;
    EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f));
    scene.camera->up = scene.camera->target - scene.camera->position;
    EXPECT_THROW(static_cast<void>(make_visible(scene, *scene.camera, 1.f, {})), Error);
}

}  // namespace
}  // namespace claray::test
