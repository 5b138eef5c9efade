// glTF: geometry, nodes, cameras, lights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::GltfBuilder;
using test::json;

using Gltf = test::GltfTest;

const std::vector<glm::vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST_F(Gltf, OneTriangle) {
    builder.triangle();
    const Scene scene = load();
    EXPECT_EQ(scene.name, "scene");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].name, "tri");
    EXPECT_EQ(scene.meshes[0].positions, corners);
    EXPECT_EQ(scene.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}}));
    EXPECT_TRUE(scene.meshes[0].normals.empty());
    EXPECT_TRUE(scene.instances.empty());
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].kind, MaterialKind::principled);
    EXPECT_EQ(scene.materials[0].albedo, glm::vec3(1.f));
    EXPECT_EQ(scene.materials[0].metallic, 1.f) << "the format's default";
    EXPECT_EQ(scene.materials[0].roughness, 1.f);
    EXPECT_TRUE(scene.materials[0].cull_back);
    EXPECT_FALSE(scene.camera);
    EXPECT_EQ(warned("neutral studio"), 1u);
}

TEST_F(Gltf, BinaryIsTheSame) {
    builder.triangle();
    builder.push("materials", {{"name", "m"}});
    primitive()["material"] = 0;
    const Scene scene = load_gltf(folder.file("scene.glb", builder.glb()), warnings);
    EXPECT_EQ(scene.meshes.at(0).positions, corners);
    EXPECT_EQ(scene.materials.at(0).name, "m");
    EXPECT_EQ(load_scene((folder / "scene.glb").string(), warnings).meshes.size(), 1u);
    load();
    EXPECT_EQ(load_scene((folder / "scene.gltf").string(), warnings).meshes.size(), 1u);
}

TEST_F(Gltf, IndicesOfEveryType) {
    builder.triangle();
    const std::vector<glm::uvec3> expected = {{2, 1, 0}};
    primitive()["indices"] = builder.accessor<std::uint8_t>("SCALAR", {2, 1, 0});
    EXPECT_EQ(load().meshes.at(0).triangles, expected);
    primitive()["indices"] = builder.accessor<std::uint16_t>("SCALAR", {2, 1, 0});
    EXPECT_EQ(load().meshes.at(0).triangles, expected);
    primitive()["indices"] = builder.accessor<std::uint32_t>("SCALAR", {2, 1, 0});
    EXPECT_EQ(load().meshes.at(0).triangles, expected);
}

TEST_F(Gltf, StripsAndFans) {
    builder.triangle();
    primitive()["attributes"]["POSITION"] =
        builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    primitive()["mode"] = 5;
    const std::vector<glm::uvec3> strip = load().meshes.at(0).triangles;
    EXPECT_EQ(strip, (std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
    const std::vector<glm::vec3> p = load().meshes.at(0).positions;
    for (const glm::uvec3& t : strip) EXPECT_GT(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z, 0.f) << "one winding";
    primitive()["mode"] = 6;
    EXPECT_EQ(load().meshes.at(0).triangles, (std::vector<glm::uvec3>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
    primitive()["mode"] = 7;
    refuse({"mesh 'tri', primitive 0", "mode 7"});
    primitive()["mode"] = 4;
    refuse({"5 indices"});
}

/// The largest distance of a vertex from the nearest of these segments; a point is one of no length.
double farthest(const Mesh& solid, const std::vector<std::pair<glm::vec3, glm::vec3>>& segments) {
    double most = 0;
    for (const glm::vec3& p : solid.positions) {
        double nearest = INFINITY;
        for (const auto& [a, b] : segments) {
            const glm::vec3 along = b - a;
            const float length2 = glm::dot(along, along);
            const float t = length2 > 0 ? glm::clamp(glm::dot(p - a, along) / length2, 0.f, 1.f) : 0.f;
            nearest = std::min(nearest, double(glm::distance(p, a + t * along)));
        }
        most = std::max(most, nearest);
    }
    return most;
}

/// The triangles of `count` spheres and tubes apart from each other.
std::size_t triangles_of(std::size_t spheres, std::size_t tubes) { return spheres * 320 + tubes * 32; }

/// A material that points and lines show as triangles: their light is sampled.
const json lamp = {{"emissiveFactor", {1, 1, 1}}};

/// Checks that each set holds these points with the radius.
void expect_points(const PrimitiveSet& set, PrimitiveSet::Kind kind, const std::vector<glm::vec3>& points,
                   float radius) {
    EXPECT_EQ(set.kind, kind);
    ASSERT_EQ(set.points.size(), points.size());
    const bool tubes = kind == PrimitiveSet::Kind::cylinders;
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_EQ(set.points[i], glm::vec4(points[i], tubes && i % 2 == 1 ? 0.f : radius)) << i;
}

TEST_F(Gltf, PointsAndLinesArePrimitives) {
    builder.triangle();
    primitive()["attributes"]["POSITION"] = builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    primitive()["attributes"]["COLOR_0"] = builder.accessor<float>("VEC3", {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
    builder.root["nodes"][0]["scale"] = {3, 1, -1};
    const glm::vec3 a(0, 0, 0), b(3, 0, 0), c(3, 1, 0), d(0, 1, 0);
    const std::vector<glm::vec3> tubes[] = {{}, {a, b, c, d}, {a, b, b, c, c, d, d, a}, {a, b, b, c, c, d}};
    for (int mode = 0; mode < 4; ++mode) {
        SCOPED_TRACE(mode);
        primitive()["mode"] = mode;
        const Scene scene = load({.stroke_radius = 0.125f});
        validate(scene);
        EXPECT_TRUE(scene.meshes.empty());
        ASSERT_EQ(scene.primitives.size(), mode == 0 ? 1u : 2u);
        expect_points(scene.primitives[0], PrimitiveSet::Kind::spheres, {a, b, c, d}, 0.125f);
        EXPECT_EQ(scene.primitives[0].colors[0], glm::vec3(1, 0, 0));
        EXPECT_EQ(warned("1 primitives of points or lines are shown"), 1u);
        if (mode == 0) continue;
        expect_points(scene.primitives[1], PrimitiveSet::Kind::cylinders, tubes[mode], 0.125f);
        EXPECT_EQ(scene.primitives[1].colors[1], glm::vec3(0, 1, 0));
    }
    const float expected = std::sqrt(10.f) / 400;
    EXPECT_NEAR(load().primitives.at(0).points[0].w, expected, 1e-6f);
    builder.root["materials"] = {
        {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}}};
    primitive()["material"] = 0;
    EXPECT_TRUE(load().primitives.empty()) << "rays pass through";
    builder.root["materials"] = {{{"alphaMode", "BLEND"}}};
    EXPECT_EQ(load().primitives.size(), 2u);
    builder.root["materials"].push_back(json::object());
    json second = primitive();
    second["material"] = 1;
    builder.root["meshes"][0]["primitives"].push_back(second);
    const Scene both = load();
    ASSERT_EQ(both.primitives.size(), 4u);
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(both.primitives[i].materials[0], i / 2) << i;
    builder.root["meshes"][0]["primitives"].erase(1);
    primitive()["attributes"]["COLOR_0"] =
        builder.accessor<float>("VEC4", {1, 0, 0, 1, 0, 1, 0, 0.5f, 0, 0, 1, 1, 1, 1, 1, 1});
    EXPECT_TRUE(load().primitives.empty()) << "rays pass through one end";
}

TEST_F(Gltf, PointsAndLinesAreSpheresAndTubes) {
    builder.triangle();
    builder.root["materials"] = {lamp};
    primitive()["material"] = 0;
    primitive()["attributes"]["POSITION"] = builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    builder.root["nodes"][0]["scale"] = {3, 1, -1};  // they are round all the same
    const glm::vec3 a(0, 0, 0), b(3, 0, 0), c(3, 1, 0), d(0, 1, 0);
    using Segments = std::vector<std::pair<glm::vec3, glm::vec3>>;
    const std::pair<Segments, std::size_t> modes[] = {{{{a, a}, {b, b}, {c, c}, {d, d}}, 0},
                                                      {{{a, b}, {c, d}}, 2},
                                                      {{{a, b}, {b, c}, {c, d}, {d, a}}, 4},
                                                      {{{a, b}, {b, c}, {c, d}}, 3}};
    for (int mode = 0; mode < 4; ++mode) {
        SCOPED_TRACE(mode);
        primitive()["mode"] = mode;
        const Scene scene = load({.stroke_radius = 0.125f});
        ASSERT_EQ(scene.meshes.size(), 1u);
        validate(scene);
        EXPECT_NEAR(farthest(scene.meshes[0], modes[mode].first), 0.125, 1e-6);
        EXPECT_EQ(scene.meshes[0].triangles.size(), triangles_of(4, modes[mode].second));
        EXPECT_EQ(warned("1 primitives of points or lines are shown"), 1u);
    }
    const float expected = std::sqrt(10.f) / 400;  // of the box's diagonal
    EXPECT_NEAR(farthest(load().meshes.at(0), modes[3].first), expected, 1e-6);
    refuse({"invalid stroke radius -1"}, {.stroke_radius = -1.f}, ErrorKind::usage);
    refuse({"contains no triangle"}, {.stroke_radius = 0.f});
    primitive()["indices"] = builder.accessor<std::uint8_t>("SCALAR", {3, 0, 2});
    EXPECT_NEAR(farthest(load({.stroke_radius = 0.1f}).meshes.at(0), {{d, a}, {a, c}}), 0.1, 1e-6);
    primitive()["mode"] = 1;
    refuse({"3 indices do not form whole lines"});
}

/// Beside triangles that are placed twice.
TEST_F(Gltf, PointsAndLinesOfInstances) {
    builder.triangle();
    builder.root["materials"] = {lamp};
    json points = primitive();
    points["mode"] = 0, points["material"] = 0;
    points["attributes"]["COLOR_0"] = builder.accessor<float>("VEC3", {1, 0, 0, 0, 1, 0, 0, 0, 1});
    builder.root["meshes"][0]["primitives"].push_back(points);
    builder.push("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
    const Scene scene = load({.stroke_radius = 0.1f});
    validate(scene);
    ASSERT_EQ(scene.meshes.size(), 3u);
    ASSERT_EQ(scene.instances.size(), 4u);
    for (const std::uint32_t i : {2u, 3u}) {
        EXPECT_EQ(scene.instances[i].mesh, i - 1);
        EXPECT_EQ(scene.instances[i].transform, glm::mat4(1.f));
    }
    const glm::vec3 x(5, 0, 0);
    EXPECT_NEAR(farthest(scene.meshes[1], {{{0, 0, 0}, {0, 0, 0}}, {{1, 0, 0}, {1, 0, 0}}, {{0, 1, 0}, {0, 1, 0}}}),
                0.1, 1e-6);
    EXPECT_NEAR(farthest(scene.meshes[2], {{x, x}, {{6, 0, 0}, {6, 0, 0}}, {{5, 1, 0}, {5, 1, 0}}}), 0.1, 1e-6);
    EXPECT_EQ(scene.meshes[2].colors.at(0), glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(load({.stroke_radius = 0.f}).instances.size(), 2u);
    EXPECT_EQ(warned("left out, as requested"), 1u);
    builder.root["materials"] = {json::object()};
    const Scene round = load({.stroke_radius = 0.1f});
    validate(round);
    EXPECT_EQ(round.instances.size(), 2u);
    ASSERT_EQ(round.primitives.size(), 2u) << "in the world";
    expect_points(round.primitives[0], PrimitiveSet::Kind::spheres, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0.1f);
    expect_points(round.primitives[1], PrimitiveSet::Kind::spheres, {x, {6, 0, 0}, {5, 1, 0}}, 0.1f);
}

TEST_F(Gltf, AttributesOfEveryType) {
    builder.triangle();
    json& attributes = primitive()["attributes"];
    attributes["NORMAL"] = builder.accessor<std::int8_t>("VEC3", {0, 0, 127, 0, 0, -128, 127, 0, 0}, true);
    attributes["TEXCOORD_0"] = builder.accessor<std::uint16_t>("VEC2", {0, 65535, 65535, 0, 0, 0}, true);
    attributes["TEXCOORD_1"] = builder.accessor<std::uint8_t>("VEC2", {0, 255, 51, 0, 0, 0}, true);
    attributes["TANGENT"] = builder.accessor<float>("VEC4", {2, 0, 0, 1, 0, 1, 0, -1, 0, 1, 0, 1});
    Scene scene = load();
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}}));
    EXPECT_EQ(mesh.uvs, (std::vector<glm::vec2>{{0, 1}, {1, 0}, {0, 0}}));
    EXPECT_EQ(mesh.uvs1, (std::vector<glm::vec2>{{0, 1}, {0.2f, 0}, {0, 0}}));
    EXPECT_TRUE(mesh.tangents.empty()) << "no normal map looks at them";
    attributes["TEXCOORD_0"] = builder.accessor<std::int8_t>("VEC2", {-128, -127, 127, 0, 0, 0}, true);
    EXPECT_EQ(load().meshes.at(0).uvs[0], glm::vec2(-1.f)) << "there is no value below -1";
    // KHR_mesh_quantization: integers that are not normalized.
    attributes["POSITION"] = builder.accessor<std::int16_t>("VEC3", {0, 0, 0, 100, 0, 0, 0, -5, 0});
    builder.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    scene = load();
    EXPECT_EQ(scene.meshes.at(0).positions, (std::vector<glm::vec3>{{0, 0, 0}, {100, 0, 0}, {0, -5, 0}}));
}

TEST_F(Gltf, NormalsOfNoLengthAreMended) {
    builder.triangle();
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 0, 3, 0, 0, NAN, 0, 0});
    EXPECT_EQ(load().meshes.at(0).normals, (std::vector<glm::vec3>{{0, 0, 1}, {1, 0, 0}, {0, 0, 1}}));
}

TEST_F(Gltf, InterleavedAndOffset) {
    builder.triangle();
    const std::vector<float> values = {9, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};
    const int view = builder.view(GltfBuilder::bytes_of_values(values), 24);
    const auto accessor = [&](int offset) {
        return builder.push(
            "accessors",
            {{"bufferView", view}, {"byteOffset", offset}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    };
    primitive()["attributes"]["POSITION"] = accessor(4);
    primitive()["attributes"]["NORMAL"] = accessor(16);
    const Scene scene = load();
    EXPECT_EQ(scene.meshes.at(0).positions, corners);
    EXPECT_EQ(scene.meshes.at(0).normals, std::vector<glm::vec3>(3, {0, 0, 1}));
}

TEST_F(Gltf, SparseAccessors) {
    builder.triangle();
    const int indices = builder.view(GltfBuilder::bytes_of_values<std::uint16_t>({1, 2}));
    const int values = builder.view(GltfBuilder::bytes_of_values<float>({5, 0, 0, 0, 6, 0}));
    const json sparse = {{"count", 2},
                         {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                         {"values", {{"bufferView", values}}}};
    const std::vector<glm::vec3> expected = {{0, 0, 0}, {5, 0, 0}, {0, 6, 0}};
    json& accessor = builder.root["accessors"][0];
    accessor["sparse"] = sparse;
    EXPECT_EQ(load().meshes.at(0).positions, expected);
    accessor.erase("bufferView");
    EXPECT_EQ(load().meshes.at(0).positions, expected) << "the others are 0 without a view";
    accessor["count"] = 2;
    refuse({"replaces element 2 of 2"});
    accessor["count"] = 1 << 30;
    refuse({"no data"});
}

TEST_F(Gltf, MeshesUsedOnceAreBaked) {
    builder.triangle();
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 1, 0, 1});
    builder.root["nodes"][0] = {{"children", {1}}, {"translation", {10, 0, 0}}};
    builder.push("nodes", {{"mesh", 0}, {"scale", {2, 3, -1}}});
    builder.root["scenes"] = {{{"nodes", {0}}}};
    const Scene scene = load();
    EXPECT_TRUE(scene.instances.empty());
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{10, 0, 0}, {12, 0, 0}, {10, 3, 0}}));
    EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 2, 1}})) << "a mirror image keeps its fronts";
    EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, -1));
    const glm::vec3 expected = glm::normalize(glm::vec3(0.5f, 0.f, -1.f));  // by the inverse transpose
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(mesh.normals[2][k], expected[k], 1e-6);
    builder.root["nodes"][1]["scale"] = {-2, 3, -1};
    EXPECT_EQ(load().meshes.at(0).triangles, (std::vector<glm::uvec3>{{0, 1, 2}})) << "half a turn is no mirror";
}

TEST_F(Gltf, MeshesUsedTwiceAreInstances) {
    builder.triangle();
    const double half = std::sqrt(0.5);
    builder.root["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}, {"translation", {1, 2, 3}}},
                             {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"scale", {2, 2, 2}}},
                             {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}}};
    const Scene scene = load();
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].positions, corners);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(glm::vec3(scene.instances[0].transform[3]), glm::vec3(1, 2, 3));
    EXPECT_EQ(glm::vec3(scene.instances[2].transform[3]), glm::vec3(8, 10, 12));
    const glm::vec4 turned =
        scene.instances[1].transform * glm::vec4(1, 0, 0, 1);  // a quarter turn about z, twice as large
    EXPECT_NEAR(turned.x, 1, 1e-6);
    EXPECT_NEAR(turned.y, 4, 1e-6);
    EXPECT_NEAR(turned.z, 3, 1e-6);
    builder.root["nodes"].erase(2);
    builder.root["nodes"][0]["children"] = {1};
    EXPECT_EQ(load().instances.size(), 2u);
}

TEST_F(Gltf, PrimitivesAreMeshesAndOnlyWhatIsUsedIsRead) {
    builder.triangle();
    json second = primitive();
    builder.push("materials", {{"name", "unused"}});
    second["material"] = builder.push("materials", {{"name", "second"}});
    builder.root["meshes"][0]["primitives"].push_back(second);
    builder.triangle();
    builder.root["nodes"].erase(1);
    const Scene scene = load();
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[1].name, "tri / 1");
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[scene.meshes[1].materials.at(0)].name, "second");
}

TEST_F(Gltf, TheDefaultSceneIsTaken) {
    builder.triangle();
    builder.triangle();
    builder.root["nodes"][1]["translation"] = {5, 0, 0};
    builder.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    EXPECT_EQ(load().meshes.at(0).positions[0].x, 0.f);
    builder.root["scene"] = 1;
    EXPECT_EQ(load().meshes.size(), 1u);
    EXPECT_EQ(load().meshes.at(0).positions[0].x, 5.f);
    builder.root["scene"] = 2;
    refuse({"scene 2 of 2"});
}

TEST_F(Gltf, Camera) {
    builder.triangle();
    builder.push("cameras",
                 {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 2}, {"znear", 1}}}});
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    const double half = std::sqrt(0.5);
    builder.push("nodes",
                 {{"camera", 1}, {"translation", {1, 2, 3}}, {"rotation", {0, half, 0, half}}, {"scale", {2, 2, 2}}});
    builder.push("nodes", {{"camera", 0}});
    builder.push("nodes", {{"camera", 1}});
    const Scene scene = load();
    ASSERT_TRUE(scene.camera);
    EXPECT_EQ(scene.camera->position, glm::vec3(1, 2, 3));
    const glm::vec3 forward = scene.camera->target - scene.camera->position;  // -z turned a quarter about +y is -x
    EXPECT_NEAR(forward.x, -1, 1e-6);
    EXPECT_NEAR(forward.z, 0, 1e-6);
    EXPECT_NEAR(scene.camera->up.y, 1, 1e-6);
    EXPECT_NEAR(scene.camera->vertical_fov, 28.6479, 1e-4);
    EXPECT_EQ(scene.camera->projection, Projection::perspective);
    EXPECT_EQ(warned("first of the cameras 0, 1, 2 is used"), 1u);
    builder.root["nodes"][1]["camera"] = 2;
    refuse({"node 1 refers to camera 2 of 2"});
}

TEST_F(Gltf, PunctualLights) {
    builder.triangle();
    builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"name", "bulb"}, {"color", {1, 0.5, 0}}, {"intensity", 8}, {"range", 20}},
        {{"type", "spot"}, {"intensity", 3}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
        {{"type", "directional"}, {"intensity", 2}, {"color", {1, 1, 1}}},
        {{"type", "spot"}, {"spot", json::object({{"innerConeAngle", 0.0}})}}};
    const auto light = [](int i) { return json{{"KHR_lights_punctual", {{"light", i}}}}; };
    builder.push("nodes", {{"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}, {"extensions", light(0)}});
    const double half = std::sqrt(0.5);
    builder.push("nodes", {{"rotation", {half, 0, 0, half}}, {"scale", {2, 2, 2}}, {"extensions", light(1)}});
    builder.push("nodes", {{"extensions", light(2)}});
    builder.push("nodes", {{"extensions", light(3)}});
    const Scene scene = load();
    ASSERT_EQ(scene.lights.size(), 4u);
    const Light& point = scene.lights[0];
    EXPECT_EQ(point.kind, LightKind::point);
    EXPECT_EQ(point.name, "bulb");
    EXPECT_EQ(point.position, glm::vec3(1, 2, 3));
    EXPECT_EQ(point.intensity, glm::vec3(8, 4, 0));
    EXPECT_EQ(point.range, 20.f);
    const Light& spot = scene.lights[1];
    EXPECT_EQ(spot.kind, LightKind::spot);
    EXPECT_NEAR(spot.direction.y, 1, 1e-6);  // -z turned a quarter about +x
    EXPECT_NEAR(glm::length(spot.direction), 1, 1e-6);
    EXPECT_FLOAT_EQ(spot.inner_angle, 0.2f);
    EXPECT_FLOAT_EQ(spot.outer_angle, 0.4f);
    EXPECT_EQ(scene.lights[2].kind, LightKind::directional);
    EXPECT_EQ(scene.lights[2].direction, glm::vec3(0, 0, -1));
    EXPECT_EQ(scene.lights[2].intensity, glm::vec3(2.f));
    EXPECT_FLOAT_EQ(scene.lights[3].outer_angle, 0.785398163f);
    EXPECT_TRUE(warnings.empty()) << warnings[0];
    builder.root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = -1;
    refuse({"light 'bulb'", "intensity"});
    builder.root["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = "area";
    refuse({"light 'bulb'", "'area'"});
    builder.root["nodes"][1]["extensions"] = light(9);
    refuse({"node 1 refers to light 9 of 4"});
}

TEST_F(Gltf, ColoursOfVerticesOfEveryType) {
    builder.triangle();
    const auto load_colors = [&](int accessor) {
        primitive()["attributes"]["COLOR_0"] = accessor;
        const Scene scene = load();
        validate(scene);
        return scene.meshes.at(0).colors;
    };
    using Colors = std::vector<glm::vec4>;
    EXPECT_EQ(load_colors(builder.accessor<float>("VEC3", {0.25f, 0, 0, 1, 0, 0, 0, 1, 0.5f})),
              (Colors{{0.25f, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0.5f, 1}}));
    EXPECT_EQ(load_colors(builder.accessor<float>("VEC4", {0.25f, 0, 0, 0.5f, 1, 0, 0, 1, 0, 1, 0.5f, 0})),
              (Colors{{0.25f, 0, 0, 0.5f}, {1, 0, 0, 1}, {0, 1, 0.5f, 0}}));
    EXPECT_EQ(load_colors(builder.accessor<std::uint8_t>("VEC4", {51, 0, 0, 255, 255, 0, 0, 0, 0, 0, 102, 255}, true)),
              (Colors{{0.2f, 0, 0, 1}, {1, 0, 0, 0}, {0, 0, 0.4f, 1}}));
    EXPECT_EQ(load_colors(builder.accessor<std::uint16_t>(
                  "VEC4", {13107, 0, 0, 65535, 65535, 0, 0, 0, 0, 0, 26214, 65535}, true)),
              (Colors{{0.2f, 0, 0, 1}, {1, 0, 0, 0}, {0, 0, 0.4f, 1}}));
    EXPECT_TRUE(load_colors(builder.accessor<float>("VEC3", {1, 1, 1, 1, 1, 1, 1, 1, 1})).empty()) << "all white";
    EXPECT_EQ(warned("clamped"), 0u);
    EXPECT_EQ(load_colors(builder.accessor<float>("VEC3", {-1, 0, 0, 2, 0, 0, 0, NAN, 0.5f})),
              (Colors{{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0.5f, 1}}));
    EXPECT_EQ(warned("clamped"), 1u);
    primitive()["attributes"]["COLOR_0"] = builder.accessor<float>("VEC2", {0, 0, 0, 0, 0, 0});
    refuse({"COLOR_0", "2 components instead of 4"});
}

TEST_F(Gltf, WhatIsLeftOutIsWarnedOf) {
    builder.triangle();
    builder.root["nodes"][0]["skin"] = builder.push("skins", {{"joints", {0}}});
    builder.root["meshes"][0]["primitives"].push_back({{"attributes", json::object()}});
    load();
    for (const char* word : {"1 nodes have skins, but their meshes have no joints", "without positions"})
        EXPECT_EQ(warned(word), 1u) << word;
}

TEST_F(Gltf, Extensions) {
    builder.triangle();
    builder.root["extensionsUsed"] = {"KHR_materials_clearcoat", "XYZ_strange"};
    load();
    EXPECT_EQ(warned("XYZ_strange"), 1u);
    EXPECT_EQ(warned("clearcoat"), 0u);
    builder.root["extensionsRequired"] = {"XYZ_strange"};
    refuse({"requires", "'XYZ_strange'"});
}

TEST_F(Gltf, BadTransforms) {
    builder.triangle();
    json& node = builder.root["nodes"][0];
    node["scale"] = {1, 1};
    refuse({"node 0", "scale has 2 numbers"});
    node["scale"] = {1e300, 1, 1};
    refuse({"node 0", "not finite"});
    node.erase("scale");
    node["rotation"] = {0, 0, 0, 0};
    refuse({"node 0", "rotation"});
    node.erase("rotation");
    node["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    refuse({"node 0", "affine"});
    node.erase("matrix");
    builder.triangle();
    builder.root["nodes"][1]["scale"] = {0, 0, 0};
    EXPECT_EQ(load().meshes.size(), 1u) << "scaled to nothing is hidden";
}

TEST_F(Gltf, NodesMustFormTrees) {
    builder.triangle();
    builder.root["nodes"] = {{{"children", {1}}, {"mesh", 0}}, {{"children", {0}}}};
    builder.root["scenes"] = {{{"nodes", {0}}}};
    refuse({"node 0", "two parents or is its own descendant"});
    builder.root["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
    builder.root["scenes"] = {{{"nodes", {0, 1}}}};
    refuse({"node 2", "two parents"});
    builder.root["nodes"] = {{{"children", {-5}}}};
    builder.root["scenes"] = {{{"nodes", {0}}}};
    refuse({"node -5 of 1"});
    // A chain of a hundred thousand nodes takes no recursion.
    builder.root["nodes"] = json::array();
    for (int i = 0; i < 100000; ++i) builder.push("nodes", {{"children", {i + 1}}});
    builder.push("nodes", {{"mesh", 0}});
    EXPECT_EQ(load().meshes.size(), 1u);
}

TEST_F(Gltf, BadReferences) {
    builder.triangle();
    const json good = builder.root;
    const auto with = [&](std::initializer_list<std::string> words, auto change) {
        builder.root = good;
        change();
        refuse(words);
    };
    with({"mesh 3 of 1"}, [&] { builder.root["nodes"][0]["mesh"] = 3; });
    with({"material 0 of 0"}, [&] { primitive()["material"] = 0; });
    with({"POSITION", "accessor 7 of 1"}, [&] { primitive()["attributes"]["POSITION"] = 7; });
    with({"POSITION", "buffer view 7 of 1"}, [&] { builder.root["accessors"][0]["bufferView"] = 7; });
    with({"buffer 7 of 1"}, [&] { builder.root["bufferViews"][0]["buffer"] = 7; });
    with({"buffer view 0 leaves its buffer"}, [&] { builder.root["bufferViews"][0]["byteLength"] = 1000; });
    with({"buffer view 0 leaves its buffer"}, [&] { builder.root["bufferViews"][0]["byteOffset"] = 4; });
    with({"exceeds its buffer view", "4 elements"}, [&] { builder.root["accessors"][0]["count"] = 4; });
    with({"exceeds its buffer view"}, [&] { builder.root["accessors"][0]["byteOffset"] = 1; });
    with({"exceeds its buffer view"}, [&] { builder.root["accessors"][0]["byteOffset"] = 1ull << 63; });
    with({"stride of 8"}, [&] { builder.root["bufferViews"][0]["byteStride"] = 8; });
    with({"2 components instead of 3"}, [&] { builder.root["accessors"][0]["type"] = "VEC2"; });
    with({"unknown type 5130"}, [&] { builder.root["accessors"][0]["componentType"] = 5130; });
    with({"refers to vertex 3 of 3"}, [&] {
        primitive()["indices"] = builder.accessor<std::uint8_t>("SCALAR", {0, 1, 3});
    });
    with({"not unsigned integers"}, [&] { primitive()["indices"] = builder.accessor<float>("SCALAR", {0, 1, 2}); });
    with({"NORMAL has 2 elements for 3"}, [&] {
        primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1});
    });
}

TEST_F(Gltf, BadFiles) {
    const auto refuse_text = [&](const std::string& text, std::initializer_list<std::string> words) {
        expect_error(ErrorKind::user, words,
                     [&] { static_cast<void>(load_gltf(folder.file("bad.gltf", text), warnings)); });
    };
    refuse_text("", {"bad.gltf", "empty"});
    refuse_text("hello", {"bad.gltf': its JSON is broken at line 1, column 1: invalid literal; export it again"});
    refuse_text("{\"asset\": {\n\"version\": \"2.0\"},,}",
                {"bad.gltf': its JSON is broken at line 2, column 19: unexpected ','; export it again"});
    refuse_text("{\"asset\": {\"version\": \"2.0\n\"}}",
                {"broken at line 2, column 0: invalid string: control character"});
    refuse_text("{\"asset\": {\"version\": ", {"broken at", "unexpected end of input; export it again"});
    refuse_text("[1, 2]", {"its JSON is no object; export"});
    refuse_text("{}", {"bad.gltf", "not a valid glTF"});
    refuse_text(R"({"asset": {"version": "1.0"}})", {"version 1.0"});
    refuse_text(R"({"asset": {"version": "2.1", "minVersion": "2.1"}})", {"version 2.1"});
    refuse_text(R"({"asset": {"version": "2.0"}})", {"no triangle"});
    refuse_text(R"({"asset": {"version": "2.0"}, "extras": )" + std::string(100000, '['), {"nested deeper"});
    refuse_text("glTF", {"cut off"});
    refuse_text("glTF" + std::string("\1\0\0\0", 4) + std::string(40, '\0'), {"version 1"});
    expect_error(ErrorKind::user, {"gone.gltf"}, [&] { static_cast<void>(load_gltf(folder / "gone.gltf", warnings)); });
}

}  // namespace
}  // namespace claray
