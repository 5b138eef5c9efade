// glTF animations: what nodes are at a time, by closed forms.
#include <cmath>
#include <numbers>

#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

class GltfAnimation : public GltfTest {
protected:
    GltfAnimation() { builder.triangle(); }

    /// An animation of node 0, in addition to those that there are.
    void animate(const char* path, const char* interpolation, const std::vector<float>& times, int values,
                 const char* name = nullptr) {
        json animation = {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}},
                          {"samplers",
                           {{{"input", builder.accessor<float>("SCALAR", times)},
                             {"output", values},
                             {"interpolation", interpolation}}}}};
        if (name) animation["name"] = name;
        builder.push("animations", animation);
    }
    json& animation() { return builder.root["animations"][0]; }

    glm::vec3 corner(double time, std::size_t index = 0, const char* name = "") {
        return load({.time = time, .animation = name}).meshes.at(0).positions.at(index);
    }
};

TEST_F(GltfAnimation, LinearBetweenKeysAndStillOutside) {
    animate("translation", "LINEAR", {1, 3, 7}, builder.accessor<float>("VEC3", {0, 1, 2, 4, 1, 0, 4, 9, 0}));
    expect_near(corner(0), {0, 1, 2});
    expect_near(corner(1), {0, 1, 2});
    expect_near(corner(1.5), {1, 1, 1.5f});
    expect_near(corner(3), {4, 1, 0});
    expect_near(corner(4), {4, 3, 0});
    expect_near(corner(1e9), {4, 9, 0});
    EXPECT_EQ(warned("rest pose"), 0u);
    expect_near(load().meshes.at(0).positions[0], {0, 0, 0});
    EXPECT_EQ(warned("shown in its rest pose, it has an animation: choose a time with --at SECONDS"), 1u);
    builder.root["accessors"][animation()["samplers"][0]["input"].get<int>()]["max"] = {7};
    load();
    EXPECT_EQ(warned("it has an animation of 7 s: choose a time"), 1u);
    animate("scale", "STEP", {0}, 0, "grow");
    load();
    EXPECT_EQ(warned("it has 2 animations of up to 7 s: choose a time with --at SECONDS, and one of 0, 'grow' with"),
              1u);
    const std::string file = folder.file("scene.gltf", builder.gltf()).string();
    EXPECT_EQ(animation_seconds(file), 7.0);
    EXPECT_EQ(animation_seconds(file, {.animation = "grow"}), 0.0);
    EXPECT_EQ(animation_seconds("cornell"), std::nullopt);
}

TEST_F(GltfAnimation, StepsHoldTheirValue) {
    animate("translation", "STEP", {1, 3}, builder.accessor<float>("VEC3", {1, 0, 0, 2, 0, 0}));
    expect_near(corner(2.999), {1, 0, 0});
    expect_near(corner(3), {2, 0, 0});
}

/// The polynomial of degree 3 with these values and slopes at both keys is found again: x = t^3 - 2 t.
TEST_F(GltfAnimation, CubicSplinesAreExactForCubics) {
    const auto x = [](double t) { return t * t * t - 2 * t; };
    const auto slope = [](double t) { return 3 * t * t - 2; };
    const std::vector<float> times = {-1, 0.5f, 3};
    std::vector<float> values;
    for (const float t : times)  // the outer tangents of both ends belong to no segment
        for (const double value : {t < 0 ? 99 : slope(t), x(t), t > 1 ? 99 : slope(t)})
            values.insert(values.end(), {float(value), 0, float(-value)});
    animate("translation", "CUBICSPLINE", times, builder.accessor<float>("VEC3", values));
    for (const double t : {0.0, 0.25, 0.5, 1.0, 2.75, 3.0}) expect_near(corner(t), glm::vec3(x(t), 0, -x(t)), 1e-5f);
}

/// A quarter turn in three seconds; after the first it is a third of that, which mixing quaternions linearly misses
/// by 1.6 degrees.
TEST_F(GltfAnimation, RotationsTurnAtConstantSpeedTheShortWay) {
    const double half = std::sqrt(0.5);
    for (const double sign : {1.0, -1.0}) {  // one rotation has two quaternions
        builder.root["animations"] = json::array();
        animate("rotation", "LINEAR", {0, 3},
                builder.accessor<float>("VEC4", {0, 0, 0, 1, 0, 0, float(sign * half), float(sign * half)}));
        expect_near(corner(1, 1), glm::vec3(std::cos(pi / 6), std::sin(pi / 6), 0));
        expect_near(corner(1.5, 1), glm::vec3(half, half, 0));
    }
}

TEST_F(GltfAnimation, CubicRotationsAreMadeUnit) {
    const float half = std::sqrt(0.5f);
    const std::vector<float> still = {0, 0, 0, 0};
    std::vector<float> values;
    for (const std::vector<float>& part : {still, {0, 0, 0, 1}, still, still, {0, 0, half, half}, still})
        values.insert(values.end(), part.begin(), part.end());
    animate("rotation", "CUBICSPLINE", {0, 2}, builder.accessor<float>("VEC4", values));
    expect_near(corner(1, 1), {half, half, 0});  // half way the mean of both, whose direction is that of 45 degrees
}

TEST_F(GltfAnimation, NormalizedIntegersAndSparseValues) {
    animate("rotation", "STEP", {0}, builder.accessor<std::int16_t>("VEC4", {0, 0, 32767, 0}, true));
    expect_near(corner(0, 1), {-1, 0, 0});
    builder.root["animations"] = json::array();
    const int scales = builder.accessor<float>("VEC3", {1, 1, 1, 1, 1, 1});
    builder.root["accessors"][scales]["sparse"] = {
        {"count", 1},
        {"indices",
         {{"bufferView", builder.view(GltfBuilder::bytes_of_values<std::uint16_t>({1}))}, {"componentType", 5123}}},
        {"values", {{"bufferView", builder.view(GltfBuilder::bytes_of_values<float>({3, 5, 7}))}}}};
    animate("scale", "LINEAR", {0, 1}, scales);
    expect_near(corner(0.5, 1), {2, 0, 0});
    expect_near(corner(0.5, 2), {0, 3, 0});
}

TEST_F(GltfAnimation, AnimatedMatricesAreTakenApart) {
    builder.root["nodes"][0]["matrix"] = {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};  // turned by 90 degrees
    animate("translation", "STEP", {0}, builder.accessor<float>("VEC3", {10, 0, 0}));
    expect_near(corner(0, 1), {10, 2, 0});
    expect_near(corner(0, 2), {7, 0, 0});
}

TEST_F(GltfAnimation, OneIsChosenByNameOrIndex) {
    for (const auto& [name, x] : {std::pair("walk", 1.f), {"run", 2.f}, {"2", 3.f}})
        animate("translation", "STEP", {0}, builder.accessor<float>("VEC3", {x, x, x}), name);
    builder.root["animations"][2]["channels"][0]["target"]["path"] = "scale";
    expect_near(corner(0), {1, 1, 1});
    expect_near(corner(0, 0, "run"), {2, 2, 2});
    expect_near(corner(0, 0, "1"), {2, 2, 2});
    expect_near(corner(0, 1, "all"), {5, 2, 2});  // scaled by 3, then moved by the later of both translations
    builder.root["animations"][0]["name"] = "1";
    expect_near(corner(0, 0, "1"), {1, 1, 1});
    LoadOptions options;
    options.animation = "fly";
    refuse({"without a time"}, options, ErrorKind::usage);
    options.time = 0;
    refuse({"scene.gltf' has no animation 'fly'; choose one of '1', 'run', '2'"}, options, ErrorKind::usage);
    options.time = NAN;
    refuse({"not finite"}, options, ErrorKind::usage);
    builder.root.erase("animations");
    options = {};
    options.time = 0;
    refuse({"has no animation; leave"}, options, ErrorKind::usage);
}

/// Ancestors move what is below them.
TEST_F(GltfAnimation, MovesChildrenAndCameras) {
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    builder.root["nodes"] = {{{"children", {1, 2}}}, {{"mesh", 0}, {"translation", {1, 0, 0}}}, {{"camera", 0}}};
    animate("translation", "LINEAR", {0, 2}, builder.accessor<float>("VEC3", {0, 0, 0, 0, 8, 0}));
    LoadOptions options;
    options.time = 0.5;
    const Scene scene = load(options);
    expect_near(scene.meshes.at(0).positions[0], {1, 2, 0});
    expect_near(scene.camera->position, {0, 2, 0});
}

TEST_F(GltfAnimation, WhatIsNotKnownIsLeftOut) {
    animate("translation", "STEP", {0}, builder.accessor<float>("VEC3", {1, 0, 0}));
    animation()["channels"].push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "pointer"}}}});
    animation()["channels"].push_back({{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}});  // no targets
    expect_near(corner(0), {1, 0, 0});
    EXPECT_EQ(warned("2 channels"), 1u);
}

TEST_F(GltfAnimation, BadOnesAreNamed) {
    animate("translation", "LINEAR", {0, 1}, builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0}), "walk");
    const json good = builder.root;
    LoadOptions options;
    options.time = 0.5;
    const auto with = [&](std::initializer_list<std::string> words, auto change) {
        builder.root = good;
        change(animation());
        refuse(words, options);
    };
    const auto times = [&](const std::vector<float>& t) { return builder.accessor<float>("SCALAR", t); };
    with({"scene.gltf", "animation 'walk', channel 0 refers to sampler 3 of 1"},
         [](json& a) { a["channels"][0]["sampler"] = 3; });
    with({"channel 0 refers to node 7 of 1"}, [](json& a) { a["channels"][0]["target"]["node"] = 7; });
    with({"channel 0 has the unknown interpolation 'BEZIER'"},
         [](json& a) { a["samplers"][0]["interpolation"] = "BEZIER"; });
    with({"channel 0: key 1 is before key 0"}, [&](json& a) { a["samplers"][0]["input"] = times({1, 0}); });
    with({"the time of key 1 is not finite"}, [&](json& a) { a["samplers"][0]["input"] = times({0, NAN}); });
    with({"has no keys"}, [&](json& a) {
        a["samplers"][0]["input"] = times({0});
        builder.root["accessors"].back()["count"] = 0;
    });
    with({"2 values instead of 3"}, [&](json& a) { a["samplers"][0]["input"] = times({0, 1, 2}); });
    with({"2 values instead of 6"}, [](json& a) { a["samplers"][0]["interpolation"] = "CUBICSPLINE"; });
    with({"its values has elements of 3 components instead of 4"},
         [](json& a) { a["channels"][0]["target"]["path"] = "rotation"; });
    with({"its times refers to accessor 99 of"}, [](json& a) { a["samplers"][0]["input"] = 99; });
    with({"its value at 0.5 s is not finite"}, [&](json& a) {
        a["samplers"][0]["output"] = builder.accessor<float>("VEC3", {0, 0, 0, INFINITY, 0, 0});
    });
}

}  // namespace
}  // namespace claray::test
