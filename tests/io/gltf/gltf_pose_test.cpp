// Skins and morph targets of glTF, by hand.
#include <cmath>

#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray::test {
namespace {

const std::vector<glm::vec3> posed_corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

/// Node 0 shows a triangle that follows two joints: node 1 at (10, 0, 0), and below it node 2, 1 above and turned by 90
/// degrees about z. At rest both are not turned, the first at the origin and the second at (0, 1, 0).
class GltfSkin : public GltfTest {
protected:
    GltfSkin() {
        builder.triangle();
        const float half = std::sqrt(0.5f);
        builder.push("nodes", {{"translation", {10, 0, 0}}, {"children", {2}}});
        builder.push("nodes", {{"translation", {0, 1, 0}}, {"rotation", {0, 0, half, half}}});
        builder.root["nodes"][0]["skin"] = 0;
        builder.root["nodes"][0]["translation"] = {0, 0, 100};  // says nothing: joints do
        builder.push("skins", {{"name", "bones"}, {"joints", {1, 2}}, {"inverseBindMatrices", inverses()}});
        follow({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0});
        primitive()["attributes"]["POSITION"] = builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 2, 0});
    }
    int inverses() {
        const int view = builder.view(GltfBuilder::bytes_of_values<float>(
            {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}));
        return builder.push("accessors",
                            {{"bufferView", view}, {"componentType", 5126}, {"count", 2}, {"type", "MAT4"}});
    }
    void follow(const std::vector<std::uint8_t>& joints, const std::vector<float>& weights, const char* set = "0") {
        primitive()["attributes"][std::string("JOINTS_") + set] = builder.accessor<std::uint8_t>("VEC4", joints);
        primitive()["attributes"][std::string("WEIGHTS_") + set] = builder.accessor<float>("VEC4", weights);
    }
    json& node(std::size_t index) { return builder.root["nodes"][index]; }
};

TEST_F(GltfSkin, VerticesFollowTheirJoints) {
    const Mesh mesh = load().meshes.at(0);
    expect_near(mesh.positions[0], {10, 0, 0});
    expect_near(mesh.positions[1], {11, 2, 0});       // (1, -1, 0) from joint 1, turned: (1, 1, 0)
    expect_near(mesh.positions[2], {9.5f, 1.5f, 0});  // (10, 2, 0) by joint 0, (9, 1, 0) by joint 1
    EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(warned("skin"), 0u);
}

TEST_F(GltfSkin, WithoutInverseBindMatricesJointsAreAtTheOriginAtRest) {
    builder.root["skins"][0].erase("inverseBindMatrices");
    expect_near(load().meshes.at(0).positions[1], {10, 2, 0});
}

TEST_F(GltfSkin, WeightsAreMadeToAddUpToOneOverAllSets) {
    follow({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, {3, 0, 0, 0, 1, 0, 0, 0, 0.1f, 0, 0, 0});
    follow({0, 0, 0, 0, 0, 0, 0, 0, 1, 9, 0, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0.1f, 0, 0, 0},
           "1");  // joint 9 counts nothing
    const Mesh mesh = load().meshes.at(0);
    expect_near(mesh.positions[0], {10, 0, 0});
    expect_near(mesh.positions[1], {11, 2, 0});
    expect_near(mesh.positions[2], {9.5f, 1.5f, 0});
    follow({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    expect_near(load().meshes.at(0).positions[0], {0, 0, 0});  // follows nothing
}

TEST_F(GltfSkin, NormalizedWeightsAndShortJoints) {
    primitive()["attributes"]["JOINTS_0"] =
        builder.accessor<std::uint16_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
    primitive()["attributes"]["WEIGHTS_0"] =
        builder.accessor<std::uint8_t>("VEC4", {255, 0, 0, 0, 255, 0, 0, 0, 51, 204, 0, 0}, true);
    expect_near(load().meshes.at(0).positions[2], {9.2f, 1.2f, 0});
}

TEST_F(GltfSkin, NormalsAndTangentsGoAlong) {
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 1, 0, 0, 0, 0, 1});
    primitive()["attributes"]["TANGENT"] = builder.accessor<float>("VEC4", {1, 0, 0, 1, 0, 1, 0, -1, 1, 0, 0, 1});
    const std::string png =
        "data:image/"
        "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
    builder.push("materials", {{"normalTexture", {{"index", builder.texture(png)}}}});
    primitive()["material"] = 0;
    Mesh mesh = load().meshes.at(0);
    expect_near(mesh.normals[1], {0, 1, 0});
    ASSERT_EQ(mesh.tangents.size(), 3u);
    expect_near(glm::vec3(mesh.tangents[1]), {-1, 0, 0});
    EXPECT_EQ(mesh.tangents[1].w, -1.f);
    // Twice as wide, before it is turned: normals by the inverse transpose, tangents by the matrix.
    node(2)["scale"] = {2, 1, 1};
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 1, 1, 0, 0, 0, 1});
    primitive()["attributes"]["TANGENT"] = builder.accessor<float>("VEC4", {1, 0, 0, 1, 1, -1, 0, 1, 1, 0, 0, 1});
    mesh = load().meshes.at(0);
    expect_near(mesh.normals[1], glm::normalize(glm::vec3(-1, 0.5f, 0)));
    expect_near(glm::vec3(mesh.tangents[1]), glm::normalize(glm::vec3(1, 2, 0)));
}

TEST_F(GltfSkin, MirrorsKeepTheirFronts) {
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 1, 0, 0});
    node(1)["scale"] = {-1, 1, 1};
    const Mesh mesh = load().meshes.at(0);
    const glm::uvec3 t = mesh.triangles.at(0);
    EXPECT_EQ(t, glm::uvec3(0, 2, 1));
    expect_near(mesh.normals[1], {0, 0, 1});
    const auto& p = mesh.positions;
    EXPECT_GT(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]).z, 0.f) << "as before";
}

/// Of what a joint of scale 0 hides, nothing is left but a point.
TEST_F(GltfSkin, JointsMayHideWhatFollowsThem) {
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    node(2)["scale"] = {0, 0, 0};
    const Mesh mesh = load().meshes.at(0);
    expect_near(mesh.positions[1], {10, 1, 0});
    for (const glm::vec3& normal : mesh.normals) EXPECT_NEAR(glm::length(normal), 1, 1e-6);
}

TEST_F(GltfSkin, JointsMayBeOutsideTheScene) {
    builder.root["scenes"] = {{{"nodes", {0}}}};
    expect_near(load().meshes.at(0).positions[1], {11, 2, 0});
}

TEST_F(GltfSkin, NodesOfOneSkinShareAMeshAndOthersDoNot) {
    builder.push("nodes", {{"mesh", 0}, {"skin", 0}});
    Scene scene = load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.instances.size(), 2u);
    builder.root["nodes"][3]["skin"] = builder.push("skins", {{"joints", {1, 1}}});
    scene = load();
    EXPECT_EQ(scene.meshes.size(), 2u);
    EXPECT_TRUE(scene.instances.empty());
    expect_near(scene.meshes[1].positions[1], {11, 0, 0});
}

TEST_F(GltfSkin, BadOnesAreNamed) {
    const json good = builder.root;
    const auto with = [&](std::initializer_list<std::string> words, auto change) {
        builder.root = good;
        change();
        refuse(words);
    };
    const auto skin = [&]() -> json& { return builder.root["skins"][0]; };
    with({"skin 5 of 1"}, [&] { node(0)["skin"] = 5; });
    with({"skin 'bones' refers to node 9 of 3"}, [&] { skin()["joints"] = {1, 9}; });
    with({"skin 'bones' has 2 inverse bind matrices for 3 joints"}, [&] { skin()["joints"] = {1, 2, 2}; });
    with({"its inverse bind matrices has elements of 3 components instead of 16"},
         [&] { skin()["inverseBindMatrices"] = 0; });
    with({"mesh 'tri', primitive 0: vertex 1 follows joint 2 of 2"}, [&] {
        follow({0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    });
    with({"vertex 0 has a weight that is not finite"}, [&] {
        follow({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, {NAN, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    });
    with({"JOINTS_0 without WEIGHTS_0"}, [&] { primitive()["attributes"].erase("WEIGHTS_0"); });
    with({"JOINTS_0 are not unsigned bytes or shorts"},
         [&] { primitive()["attributes"]["JOINTS_0"] = builder.accessor<float>("VEC4", std::vector<float>(12, 0.f)); });
    with({"WEIGHTS_0 has 2 elements for 3 vertices"},
         [&] { primitive()["attributes"]["WEIGHTS_0"] = builder.accessor<float>("VEC4", std::vector<float>(8, 0.f)); });
    with({"skin 'bones': its joint 1 is its own descendant"}, [&] {
        builder.push("nodes", {{"children", {2}}});
        node(1).erase("children");
        node(2)["children"] = {3};
        builder.root["scenes"] = {{{"nodes", {0, 1}}}};
    });
    with({"skin 'bones': the matrix of joint 1 is not finite"}, [&] {
        std::vector<float> numbers(32, 0.f);
        numbers[20] = NAN;
        const int view = builder.view(GltfBuilder::bytes_of_values(numbers));
        builder.root["accessors"][skin()["inverseBindMatrices"].get<int>()]["bufferView"] = view;
    });
}

/// Two targets: the first lifts all corners by z, the second moves corner 1 by x.
class GltfMorph : public GltfTest {
protected:
    GltfMorph() {
        builder.triangle();
        const int up = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
        const int aside = builder.accessor<float>("VEC3", {0, 0, 0, 4, 0, 0, 0, 0, 0});
        primitive()["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}}};
    }
    glm::vec3 corner() { return load().meshes.at(0).positions.at(1); }
};

TEST_F(GltfMorph, WeightsOfTheMeshAndOfTheNode) {
    expect_near(corner(), {1, 0, 0});
    EXPECT_TRUE(warned("morph") == 0u);
    builder.root["meshes"][0]["weights"] = {2, 0.25};
    expect_near(corner(), {2, 0, 2});
    builder.root["nodes"][0]["weights"] = {0, -1};
    expect_near(corner(), {-3, 0, 0});
    builder.root["nodes"][0]["weights"] = {0, 1, 7};  // one too many says nothing
    expect_near(corner(), {5, 0, 0});
    builder.root["nodes"][0]["weights"] = {0.5};  // missing ones are 0
    expect_near(corner(), {1, 0, 0.5f});
}

TEST_F(GltfMorph, EveryAttributeThatHasMoves) {
    json& attributes = primitive()["attributes"];
    attributes["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    attributes["TEXCOORD_0"] = builder.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1});
    attributes["TEXCOORD_1"] = builder.accessor<std::uint8_t>("VEC2", {0, 0, 255, 0, 0, 255}, true);
    primitive()["targets"][0]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 0, 2, 0, 0, 0, 0, 0});
    primitive()["targets"][0]["TEXCOORD_0"] = builder.accessor<std::int8_t>("VEC2", {0, 0, 127, -127, 0, 0}, true);
    primitive()["targets"][1]["TEXCOORD_1"] = builder.accessor<float>("VEC2", {0, 0, -1, 0, 0, 0});
    builder.root["meshes"][0]["weights"] = {0.5, 0.5};
    const Mesh mesh = load().meshes.at(0);
    expect_near(mesh.normals[1], glm::normalize(glm::vec3(1, 0, 1)));
    EXPECT_EQ(mesh.uvs[1], glm::vec2(1.5f, -0.5f));
    EXPECT_EQ(mesh.uvs1[1], glm::vec2(0.5f, 0));
}

TEST_F(GltfMorph, SparseTargets) {
    const int indices = builder.view(GltfBuilder::bytes_of_values<std::uint16_t>({1}));
    const int values = builder.view(GltfBuilder::bytes_of_values<float>({0, 3, 0}));
    primitive()["targets"][0]["POSITION"] =
        builder.push("accessors", {{"componentType", 5126},
                                   {"count", 3},
                                   {"type", "VEC3"},
                                   {"sparse",
                                    {{"count", 1},
                                     {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                     {"values", {{"bufferView", values}}}}}});
    builder.root["meshes"][0]["weights"] = {1, 0};
    EXPECT_EQ(load().meshes.at(0).positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 3, 0}, {0, 1, 0}}));
}

TEST_F(GltfMorph, AnimatedWeights) {
    builder.push("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
                                {"samplers",
                                 {{{"input", builder.accessor<float>("SCALAR", {0, 1})},
                                   {"output", builder.accessor<std::uint8_t>("SCALAR", {0, 0, 255, 51}, true)}}}}});
    LoadOptions options;
    options.time = 0.5;
    expect_near(load(options).meshes.at(0).positions.at(1), {1.4f, 0, 0.5f});
}

TEST_F(GltfMorph, NodesOfOtherWeightsHaveOtherMeshes) {
    builder.push("nodes", {{"mesh", 0}, {"weights", {1, 0}}});
    Scene scene = load();
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_TRUE(scene.instances.empty());
    expect_near(scene.meshes[1].positions[1], {1, 0, 1});
    builder.push("nodes", {{"mesh", 0}, {"weights", {1, 0}}, {"translation", {0, 5, 0}}});
    scene = load();
    EXPECT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.instances.size(), 3u);
}

TEST_F(GltfMorph, BadOnesAreNamed) {
    builder.root["meshes"][0]["weights"] = {1, 1};
    primitive()["targets"][1]["POSITION"] = builder.accessor<float>("VEC3", {0, 0, 0});
    refuse({"mesh 'tri', primitive 0: POSITION of morph target 1 has 1 elements for 3 vertices"});
    primitive()["targets"][1]["POSITION"] = builder.accessor<float>("VEC2", {0, 0, 0, 0, 0, 0});
    refuse({"POSITION of morph target 1 has elements of 2 components instead of 3"});
    primitive()["targets"][1]["POSITION"] = 99;
    refuse({"POSITION of morph target 1 refers to accessor 99 of"});
}

}  // namespace
}  // namespace claray::test
