// glTF: where its bytes are, and how strictly they are read.
#include <gtest/gtest.h>

#include "tests/io/gltf/gltf_fixture.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::json;

using GltfBytes = test::GltfTest;

const std::vector<glm::vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST_F(GltfBytes, BinaryChunksStayInTheirFile) {
    builder.triangle();
    const auto refuse_glb = [&](const std::string& glb, const char* words) {
        const auto path = folder.file("bad.glb", glb);
        expect_error(ErrorKind::user, {"bad.glb", words}, [&] { static_cast<void>(load_gltf(path, warnings)); });
    };
    const std::string glb = builder.glb();
    const std::size_t binary = glb.find(std::string("BIN\0", 4)) - 4;
    for (const int more : {4, 8, 100}) {  // tinygltf 2.7 takes up to 8 bytes from behind the end
        std::string longer = glb;
        longer[binary] = char(longer[binary] + more);
        refuse_glb(longer, "chunk 1 is cut off");
    }
    std::string without = glb;
    without[12] = char(0xfc), without[13] = without[14] = without[15] = char(0xff);  // adds up to less than 2^32
    refuse_glb(without, "chunk 0 is cut off");
    for (int length = 0; length < 20; ++length) {
        std::string shorter = glb;
        shorter[8] = char(length), shorter[9] = shorter[10] = shorter[11] = 0;
        refuse_glb(shorter, ("states a length of " + std::to_string(length) + " bytes").c_str());
    }
    std::string other = glb;
    other[16] = 'X';
    refuse_glb(other, "its first chunk is not JSON");
    EXPECT_EQ(load_gltf(folder.file("more.glb", glb + "behind"), warnings).meshes.size(), 1u);
}

TEST_F(GltfBytes, ExternalBuffer) {
    builder.triangle();
    static_cast<void>(folder.file("a b.bin", builder.buffer()));
    builder.root["buffers"] = {{{"byteLength", builder.buffer().size()}, {"uri", "a%20b.bin"}}};
    const auto load_text = [&] { return load_gltf(folder.file("scene.gltf", builder.root.dump()), warnings); };
    EXPECT_EQ(load_text().meshes.at(0).positions, corners);
    const auto refuse_text = [&](std::initializer_list<std::string> words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(load_text()); });
    };
    builder.root["buffers"][0]["uri"] = "gone.bin";
    refuse_text({"gone.bin", "put the buffer next to"});
    builder.root["buffers"][0]["uri"] = "%2e%2e/secret.bin";
    refuse_text({"../secret.bin", "leaves the scene's folder"});
    builder.root["buffers"][0]["uri"] = "a%20b.bin";
    builder.root["buffers"][0]["byteLength"] = 1000;
    refuse_text({"scene.gltf", "has 36 bytes instead of 1000"});
    static_cast<void>(folder.file("a b.bin", builder.buffer() + "padding"));
    builder.root["buffers"][0]["byteLength"] = builder.buffer().size();
    EXPECT_EQ(load_text().meshes.at(0).positions, corners);
    builder.root["buffers"][0].erase("byteLength");
    refuse_text({"buffer 0 has no byteLength"});
}

TEST_F(GltfBytes, BuffersOfDataUris) {
    builder.triangle();
    const std::string data = test::base64(builder.buffer());
    for (const std::string& uri : {"data:;base64," + data, "data:model/x;charset=utf-8;base64," + data}) {
        builder.root["buffers"] = {{{"byteLength", builder.buffer().size()}, {"uri", uri}}};
        EXPECT_EQ(load_gltf(folder.file("s.gltf", builder.root.dump()), warnings).meshes.at(0).positions, corners);
    }
    builder.root["buffers"][0]["uri"] = "data:;base64,A*A";
    expect_error(ErrorKind::user, {"buffer 0", "base64"},
                 [&] { static_cast<void>(load_gltf(folder.file("s.gltf", builder.root.dump()), warnings)); });
    builder.root["buffers"].push_back({{"byteLength", 4}});
    builder.root["buffers"][0]["uri"] = "data:;base64," + data;
    EXPECT_EQ(load_gltf(folder.file("s.gltf", builder.root.dump()), warnings).meshes.at(0).positions, corners)
        << "nothing needs the second one";
    builder.root["buffers"][0].erase("uri");
    expect_error(ErrorKind::user, {"buffer 0 has neither a URI nor a binary chunk"},
                 [&] { static_cast<void>(load_gltf(folder.file("s.gltf", builder.root.dump()), warnings)); });
}

/// Binary files may have chunks that are not padded, others behind them, and an empty buffer.
TEST_F(GltfBytes, ChunksOfEveryKind) {
    builder.triangle();
    builder.more_buffers = {{{"byteLength", 0}, {"uri", "data:,"}}};
    std::string glb = builder.glb() + std::string("\3\0\0\0XYZ\0abc", 11);
    glb[8] = char(glb.size()), glb[9] = char(glb.size() >> 8);
    EXPECT_EQ(load_gltf(folder.file("s.glb", glb), warnings).meshes.at(0).positions, corners);
}

/// As the specification allows them: indices that are all 0, and whole numbers with a point.
TEST_F(GltfBytes, ValidFilesThatParsersRefuse) {
    builder.triangle();
    primitive()["indices"] = builder.push("accessors", {{"componentType", 5125}, {"count", 3}, {"type", "SCALAR"}});
    EXPECT_EQ(load().meshes.at(0).triangles, (std::vector<glm::uvec3>{{0, 0, 0}}));
    primitive().erase("indices");
    for (json& view : builder.root["bufferViews"])
        for (const char* key : {"buffer", "byteOffset", "byteLength"}) view[key] = view[key].get<double>();
    builder.root["nodes"][0]["mesh"] = 0.0;
    builder.root["accessors"][0]["count"] = 3.0;
    EXPECT_EQ(load().meshes.at(0).positions, corners);
    builder.push("skins", {{"joints", {0}}});
    load();
    EXPECT_EQ(warned("inverseBindMatrices"), 0u);
    builder.push("skins", json::object());
    refuse({"not a valid glTF: "});
}

/// What KHR_animation_pointer moves is no node.
TEST_F(GltfBytes, ChannelsWithoutNodeAreLeftOut) {
    builder.triangle();
    const int times = builder.accessor<float>("SCALAR", {0, 1});
    const int values = builder.accessor<float>("VEC3", {0, 0, 0, 4, 0, 0});
    const json pointer = {
        {"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", json::object()}}}}}};
    const json node = {{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}};
    builder.push("animations",
                 {{"channels", {pointer, node, pointer}}, {"samplers", {{{"input", times}, {"output", values}}}}});
    EXPECT_EQ(load({.time = 0.5}).meshes.at(0).positions[0].x, 2.f);
    EXPECT_EQ(warned("2 channels animate unsupported properties: they are left out"), 1u);
    EXPECT_EQ(warned("field is missing"), 0u);
    json& channels = builder.root["animations"][0]["channels"];
    for (json& channel : channels) channel = {{"target", {{"node", 0}, {"path", "scale"}}}};
    load();
    EXPECT_EQ(warned("scene.gltf' is not quite a valid glTF: 'sampler' property is missing"), 1u) << "of three";
}

/// A mesh that is flattened is shown flat, and where it has no size left an animation goes on.
TEST_F(GltfBytes, TransformsWithoutInverse) {
    builder.triangle();
    primitive()["attributes"]["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    builder.root["nodes"][0]["scale"] = {1, 0, 1};
    const Scene flat = load();
    validate(flat);
    EXPECT_EQ(flat.meshes.at(0).positions[2], glm::vec3(0.f));
    EXPECT_TRUE(flat.meshes[0].normals.empty());
    const double half = std::sqrt(0.5);
    builder.root["nodes"] = {{{"mesh", 0}},
                             {{"children", {2}}, {"scale", {1, 1, 1e-6}}},
                             {{"mesh", 0}, {"rotation", {half * half, half * half, 0, half}}},
                             {{"mesh", 0}, {"translation", {3, 0, 0}}}};
    const Scene scene = load();
    validate(scene);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.meshes.size(), 2u) << "the one that is too flat for rays to be transformed is a mesh of its own";
    EXPECT_EQ(scene.instances[1].transform, glm::mat4(1.f));
    builder.root["nodes"] = {{{"mesh", 0}, {"scale", {0, 0, 0}}}};
    refuse({"contains no triangle"});
    builder.push("animations", {{"channels", json::array()}, {"samplers", json::array()}});
    EXPECT_EQ(load({.time = 0.0}).meshes.size(), 1u);
}

/// Primitives are as good as triangles but for their light, which is not sampled. Many lamps of many triangles take
/// long.
TEST_F(GltfBytes, ManyPointsThatShineArePrimitives) {
    builder.triangle();
    builder.root["materials"] = {{{"emissiveFactor", {1, 1, 1}}}};
    primitive()["material"] = 0, primitive()["mode"] = 0;
    EXPECT_EQ(load().meshes.size(), 1u) << "a few are lamps";
    std::vector<float> many(3 * 2000);
    for (std::size_t i = 0; i < many.size(); ++i) many[i] = float(i);
    primitive()["attributes"]["POSITION"] = builder.accessor<float>("VEC3", many);
    const Scene scene = load();
    EXPECT_TRUE(scene.meshes.empty());
    ASSERT_EQ(scene.primitives.size(), 1u);
    EXPECT_EQ(scene.primitives[0].points.size(), 2000u);
}

/// Models of other programs have other extensions, or none.
TEST_F(GltfBytes, FilesOfUnknownNamesAreReadByTheirContent) {
    builder.triangle();
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string stl =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid\n";
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    std::string binary_stl(84 + 50, '\0');
    binary_stl[80] = 1;
    binary_stl[84 + 12 + 2] = binary_stl[84 + 24 + 2] = char(0x80);  // 1.0f is 00 00 80 3f
    binary_stl[84 + 12 + 3] = binary_stl[84 + 24 + 7] = char(0x3f);
    for (const std::string& bytes :
         {builder.glb(), "\xef\xbb\xbf " + builder.gltf(), "# made by hand\n\n" + triangle, stl, ply, binary_stl})
        for (const char* name : {"model", "model.vrm", "model.xyz"})
            EXPECT_EQ(triangle_count(load_scene(folder.file(name, bytes).string(), warnings)), 1u)
                << name << ' ' << bytes.substr(0, 20);
    const std::string text = folder.file("notes.txt", "hello\nv 1 2 3\n").string();
    expect_error(ErrorKind::user, {"notes.txt' is none of the files that claray reads: glTF, PLY, ", "; convert"},
                 [&] { static_cast<void>(load_scene(text, warnings)); });
}

}  // namespace
}  // namespace claray
