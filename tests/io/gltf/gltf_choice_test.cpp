// What is chosen of a glTF: scene, camera, variant; and instances by EXT_mesh_gpu_instancing.
#include <cmath>

#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray::test {
namespace {

using GltfChoice = GltfTest;

LoadOptions scene_named(const char* name) { return {.scene = name}; }
LoadOptions camera_named(const char* name) { return {.camera = name}; }
LoadOptions variant_named(const char* name) { return {.variant = name}; }

TEST_F(GltfChoice, Scenes) {
    builder.triangle();
    builder.triangle();
    builder.root["nodes"][1]["translation"] = {5, 0, 0};
    builder.root["scenes"] = {{{"nodes", {0}}, {"name", "day"}}, {{"nodes", {1}}, {"name", "night"}}};
    const auto x = [&](const char* name) { return load(scene_named(name)).meshes.at(0).positions[0].x; };
    EXPECT_EQ(x(""), 0.f);
    EXPECT_EQ(x("night"), 5.f);
    EXPECT_EQ(x("1"), 5.f);
    builder.root["scene"] = 1;
    EXPECT_EQ(x(""), 5.f);
    EXPECT_EQ(x("day"), 0.f);
    refuse({"has no scene 'dusk'; choose one of 'day', 'night'"}, scene_named("dusk"), ErrorKind::usage);
    refuse({"has no scene '2'"}, scene_named("2"), ErrorKind::usage);
    refuse({"has no scene '-1'"}, scene_named("-1"), ErrorKind::usage);
}

TEST_F(GltfChoice, Cameras) {
    builder.triangle();
    builder.push("cameras",
                 {{"name", "wide"}, {"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    builder.push("cameras", {{"name", "plan"},
                             {"type", "orthographic"},
                             {"orthographic", {{"xmag", 3}, {"ymag", 2.5}, {"zfar", 9}, {"znear", 0}}}});
    builder.push("nodes", {{"camera", 0}, {"name", "door"}});
    builder.push("nodes", {{"camera", 1}, {"translation", {0, 0, 7}}});
    builder.push("nodes", {{"camera", 0}, {"name", "window"}, {"translation", {0, 0, 8}}});
    const auto z = [&](const char* name) { return load(camera_named(name)).camera->position.z; };
    EXPECT_EQ(z(""), 0.f);
    EXPECT_EQ(warned("first of the cameras 'door', 'plan', 'window' is used: choose another with --file-camera"), 1u);
    EXPECT_EQ(z("window"), 8.f);
    EXPECT_EQ(warned("camera"), 0u);
    EXPECT_EQ(z("2"), 8.f);
    EXPECT_EQ(z("wide"), 0.f);
    const Scene scene = load(camera_named("plan"));
    EXPECT_EQ(scene.camera->position.z, 7.f);
    EXPECT_EQ(scene.camera->projection, Projection::orthographic);
    EXPECT_EQ(scene.camera->orthographic_height, 5.f);
    refuse({"has no camera 'roof'; choose one of 'door', 'plan', 'window'"}, camera_named("roof"), ErrorKind::usage);
    builder.root["cameras"][1]["orthographic"]["ymag"] = 0;
    refuse({"camera 'plan': its ymag is 0"}, camera_named("plan"));
    EXPECT_NO_THROW(static_cast<void>(load()));
    builder.root["nodes"] = {{{"mesh", 0}}};
    refuse({"has no camera; leave"}, camera_named("plan"), ErrorKind::usage);
}

TEST_F(GltfChoice, ALiveViewKnowsObjects) {
    builder.triangle();
    json& primitives = builder.root["meshes"][0]["primitives"];
    primitives.push_back(primitives[0]);
    for (int i = 0; i < 3; ++i) builder.triangle();
    const char* const names[] = {"hero", "side", "hero", ""};
    for (int i = 0; i < 4; ++i)
        builder.root["nodes"][i]["name"] = names[i], builder.root["nodes"][i]["translation"] = {2 * i, 0, 0};
    const auto objects = [&] {
        std::string found;
        for (const MeshInstance& instance : load({.live = true}).instances)
            found += std::to_string(instance.mesh) + " " + instance.name + ", ";
        return found;
    };
    EXPECT_EQ(objects(), "0 hero, 1 hero, 2 side, 3 hero (node 2), 4 node 3, ");
    const Scene live = load({.live = true}), still = load();
    EXPECT_TRUE(still.instances.empty());
    ASSERT_EQ(live.meshes.size(), still.meshes.size());
    for (std::size_t i = 0; i < live.meshes.size(); ++i) {
        EXPECT_EQ(live.meshes[i].positions, still.meshes[i].positions);
        EXPECT_EQ(live.instances[i].transform, glm::mat4(1.f)) << "meshes stay in the world";
    }
    builder.root["nodes"][1]["mesh"] = 0;  // shown twice
    EXPECT_EQ(objects(), "0 hero, 1 hero, 0 side, 1 side, 2 hero (node 2), 3 node 3, ");
    EXPECT_EQ(load({.live = true}).instances.at(3).transform[3].x, 2.f);
    EXPECT_EQ(load().instances.size(), 6u);
}

TEST_F(GltfChoice, ALiveViewAimsAtTheScene) {
    builder.triangle();
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    builder.push("nodes", {{"camera", 0}, {"translation", {0, 0, 7}}});
    EXPECT_EQ(load().camera->target, glm::vec3(0, 0, 6));
    expect_near(load({.live = true}).camera->target, {0, 0, 0});
    EXPECT_EQ(load({.live = true}).camera->position, glm::vec3(0, 0, 7));
    builder.root["nodes"][1]["translation"] = {0, 0, -7};  // it looks away
    expect_near(load({.live = true}).camera->target, {0, 0, -7 - 0.25f * std::sqrt(2.f)});
}

TEST_F(GltfChoice, VariantsOfMaterials) {
    builder.triangle();
    for (const char* name : {"black", "white", "red"}) builder.push("materials", {{"name", name}});
    primitive()["material"] = 0;
    builder.root["extensionsUsed"] = {"KHR_materials_variants"};
    builder.root["extensions"]["KHR_materials_variants"]["variants"] = {
        {{"name", "night"}}, {{"name", "day"}}, {{"name", "dusk"}}};
    primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"variants", {1}}, {"material", 1}},
                                                                       {{"variants", {0, 2}}, {"material", 2}}};
    const auto material = [&](const char* name) { return load(variant_named(name)).materials.at(0).name; };
    EXPECT_EQ(material(""), "black");
    EXPECT_EQ(warned("variants, 'night', 'day', 'dusk': choose one with --variant"), 1u);
    EXPECT_EQ(material("day"), "white");
    EXPECT_TRUE(warned("variant") == 0u);
    EXPECT_EQ(material("night"), "red");
    EXPECT_EQ(material("2"), "red");
    refuse({"has no variant 'noon'; choose one of 'night', 'day', 'dusk'"}, variant_named("noon"), ErrorKind::usage);
    primitive()["extensions"]["KHR_materials_variants"]["mappings"].erase(1);
    EXPECT_EQ(material("night"), "black") << "what the variant does not change";
    primitive()["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] = 9;
    refuse({"mesh 'tri' refers to material 9 of 3"}, variant_named("day"));
    builder.root.erase("extensions");
    refuse({"has no variant; leave"}, variant_named("day"), ErrorKind::usage);
}

TEST_F(GltfChoice, OtherFormatsHaveNone) {
    const std::string obj = folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
    for (const std::string& name : {obj, std::string("cornell")})
        for (const LoadOptions& options :
             {LoadOptions{.time = 1}, scene_named("0"), camera_named("0"), variant_named("0")})
            expect_error(ErrorKind::usage, {name + "' has no ", "only glTF"},
                         [&] { static_cast<void>(load_scene(name, warnings, options)); });
}

TEST_F(GltfChoice, LongListsAreCut) {
    builder.triangle();
    for (int i = 0; i < 500; ++i)
        builder.push("scenes", {{"nodes", {0}}, {"name", std::string(60, 'x') + std::to_string(i)}});
    try {
        static_cast<void>(load(scene_named("none")));
        FAIL();
    } catch (const Error& error) {
        EXPECT_LT(std::string(error.what()).size() - folder.file("scene.gltf", "").string().size(), 300u)
            << error.what();
        EXPECT_NE(std::string(error.what()).find("(500 in total)"), std::string::npos) << error.what();
    }
}

/// The instances of the extension are moved, turned and scaled in the space of their node.
TEST_F(GltfChoice, InstancesOfANode) {
    builder.triangle();
    json& node = builder.root["nodes"][0];
    node["translation"] = {0, 0, 9};
    node["scale"] = {2, 2, 2};
    json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = builder.accessor<float>("VEC3", {0, 0, 0, 1, 2, 3});
    attributes["ROTATION"] = builder.accessor<std::int16_t>("VEC4", {0, 0, 0, 32767, 0, 0, 23170, 23170}, true);
    attributes["SCALE"] = builder.accessor<float>("VEC3", {1, 1, 1, 5, 1, 1});
    builder.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    Scene scene = load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    const auto corner = [&](std::size_t i) { return glm::vec3(scene.instances[i].transform * glm::vec4(1, 0, 0, 1)); };
    expect_near(corner(0), {2, 0, 9});
    expect_near(corner(1), {2, 14, 15}, 1e-5f);  // 5 along y, moved by (1, 2, 3), twice as large, moved by the node
    attributes["ROTATION"] = builder.accessor<std::int8_t>("VEC4", {0, 0, 0, 127, 0, 0, 127, 0}, true);
    scene = load();
    expect_near(corner(1), {-8, 4, 15}, 1e-5f);
    attributes.erase("TRANSLATION"), attributes.erase("ROTATION");
    attributes["SCALE"] = builder.accessor<float>("VEC3", {0, 0, 0, 3, 3, 3});
    scene = load();
    EXPECT_TRUE(scene.instances.empty()) << "the first is hidden, and the other one needs no second level";
    expect_near(scene.meshes.at(0).positions[1], {6, 0, 9});
    attributes["TRANSLATION"] = builder.accessor<float>("VEC3", {0, 0, 0});
    refuse({"node 0: ", " of its instances has ", "elements for "});
    attributes["TRANSLATION"] = 77;
    refuse({"node 0: TRANSLATION of its instances refers to accessor 77"});
    attributes.erase("TRANSLATION");
    attributes["ROTATION"] = builder.accessor<float>("VEC4", std::vector<float>(8, 0.f));
    refuse({"node 0: the rotation of its instance 0 has length 0"});
    node["extensions"]["EXT_mesh_gpu_instancing"] = json::object();
    EXPECT_EQ(load().meshes.size(), 1u) << "without attributes it is a node like any other";
}

}  // namespace
}  // namespace claray::test
