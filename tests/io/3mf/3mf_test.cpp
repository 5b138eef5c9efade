// 3MF: objects, components of other parts, properties, and archives that are damaged.
#include <gtest/gtest.h>

#include <cmath>

#include "host/io/3mf/zip_file.hpp"
#include "tests/io/expect_error.hpp"

namespace claray {
namespace {

using test::expect_error;

const std::filesystem::path archives = std::filesystem::path(CLARAY_SOURCE_DIR) / "tests/fuzz/corpus/3mf";

void expect_close(const glm::vec3& a, const glm::vec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-6f) << a.x << ' ' << a.y << ' ' << a.z;
}

std::string little_endian(std::size_t value, std::size_t bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) text += char(value >> (8 * i));
    return text;
}

/// An archive of one part, which is stored.
std::string stored_archive(const std::string& name, const std::string& content) {
    const std::string sizes =
        little_endian(content.size(), 4) + little_endian(content.size(), 4) + little_endian(name.size(), 2);
    const std::string local =
        "PK\3\4" + little_endian(20, 2) + little_endian(0, 12) + sizes + little_endian(0, 2) + name + content;
    const std::string entry = "PK\1\2" + little_endian(20, 2) + little_endian(20, 2) + little_endian(0, 12) + sizes +
                              little_endian(0, 16) + name;
    return local + entry + "PK\5\6" + little_endian(0, 4) + little_endian(1, 2) + little_endian(1, 2) +
           little_endian(entry.size(), 4) + little_endian(local.size(), 4) + little_endian(0, 2);
}

std::string model_text(const std::string& resources, const std::string& items) {
    return "<model><resources>" + resources + "</resources><build>" + items + "</build></model>";
}

const std::string triangle_object =
    "<object id='1'><mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='0' z='1'/>"
    "</vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh></object>";
const std::string one_item = "<item objectid='1'/>";

class ThreeMf : public test::ReaderTest {
protected:
    Scene load(const std::string& bytes) { return load_scene(folder.file("a.3mf", bytes).string(), warnings); }
    void refuse(const std::string& bytes, const std::string& what) {
        expect_error(ErrorKind::user, {"a.3mf'", what}, [&] { static_cast<void>(load(bytes)); });
    }
    void refuse_model(const std::string& resources, const std::string& items, const std::string& what) {
        refuse(stored_archive("3D/3dmodel.model", model_text(resources, items)), what);
    }
};

/// Millimetres, and z upwards.
TEST_F(ThreeMf, ItemsOfOneObject) {
    const Scene scene = load(test::read_file(archives / "tetrahedra.3mf"));
    EXPECT_EQ(triangle_count(scene), 8u);
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    expect_close(bounds_of(scene).lo, {0, 0, -0.01f});
    expect_close(bounds_of(scene).hi, {0.03f, 0.01f, 0});
    expect_close(glm::vec3(scene.meshes[0].colors.at(0)), {1, 0, 0});
}

/// Deflated, in centimetres, with components, colours, mixtures, layers and an image.
TEST_F(ThreeMf, PropertiesAndParts) {
    const Scene scene = load(test::read_file(archives / "properties.3mf"));
    ASSERT_EQ(scene.meshes.size(), 2u);
    ASSERT_EQ(scene.instances.size(), 3u);
    const auto vertex = [&](std::size_t instance, std::uint32_t i) {
        const MeshInstance& placed = scene.instances[instance];
        return glm::vec3(placed.transform * glm::vec4(scene.meshes[placed.mesh].positions[i], 1.f));
    };
    const Mesh& leaf = scene.meshes.at(scene.instances[0].mesh);
    EXPECT_EQ(scene.instances[0].name, "leaf");
    expect_close(vertex(0, leaf.triangles[0].z), {0, 0.02f, 0});
    expect_close(vertex(2, leaf.triangles[0].y), {0.12f, 0, 0});
    expect_close(vertex(1, scene.meshes.at(scene.instances[1].mesh).triangles[0].z), {0, 0.05f, -0.01f});

    const auto color = [&](std::size_t t, int corner) { return leaf.colors[leaf.triangles[t][corner]]; };
    EXPECT_EQ(color(0, 0), glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(color(0, 1), glm::vec4(0, 1, 0, 128 / 255.f));
    EXPECT_EQ(color(2, 1), glm::vec4(0, 0, 1, 1)) << "the object's";
    EXPECT_EQ(color(3, 1), glm::vec4(0.25f, 0, 0.75f, 1)) << "a mixture";
    EXPECT_EQ(color(4, 0), glm::vec4(0, 0, 1, 1)) << "the first layer";
    EXPECT_EQ(warned("only the first is shown"), 1u);
    EXPECT_TRUE(scene.materials.at(leaf.materials[0]).alpha_mode == AlphaMode::blend);

    const Material& checks = scene.materials.at(leaf.materials[1]);
    ASSERT_TRUE(checks.albedo_map.used());
    const Texture& image = scene.textures.at(checks.albedo_map.texture);
    EXPECT_EQ(image.width, 2u);
    EXPECT_TRUE(image.wrap_u == Wrap::mirror && image.wrap_v == Wrap::clamp);
    EXPECT_EQ(leaf.uvs[leaf.triangles[1].y], glm::vec2(0, 0.75f)) << "v counts from the top";
}

TEST_F(ThreeMf, ContentTellsTheFormat) {
    const std::string path =
        folder.file("model", stored_archive("3D/3dmodel.model", model_text(triangle_object, one_item))).string();
    EXPECT_EQ(triangle_count(load_scene(path, warnings)), 1u);
}

TEST_F(ThreeMf, WhatIsDamagedIsRefused) {
    refuse("", "is empty");
    refuse("PK\3\4 and no end", "no zip archive");
    refuse(stored_archive("other", "x"), "has no part '3D/3dmodel.model'");
    refuse(stored_archive("3D/3dmodel.model", "<model>"), "is no XML");
    const std::string good = test::read_file(archives / "properties.3mf");
    for (std::size_t cut = 1; cut < 10; ++cut) refuse(good.substr(0, good.size() * cut / 10), "a.3mf");
    refuse_model("", one_item, "has no object '1'");
    refuse_model(triangle_object, "", "contains no triangle");
    refuse_model("<object id='1'><mesh/></object>", one_item, "contains no triangle");
    const auto changed = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    refuse_model(changed(triangle_object, "v3='2'", "v3='3'"), one_item, "'3' is out of range, there are 3 vertices");
    refuse_model(changed(triangle_object, "x='1'", "x='one'"), one_item, "'one' is no number of vertices");
    refuse_model(triangle_object, "<item objectid='1' transform='1 2'/>", "is no number of a transform");
    refuse_model("<basematerials id='2'><base displaycolor='red'/></basematerials>" + triangle_object, one_item,
                 "'red' is no colour");
    refuse(stored_archive("3D/3dmodel.model",
                          changed(model_text(triangle_object, one_item), "<model>", "<model unit='mile'>")),
           "'mile'");
}

/// Each object shows the one before it twice: 2^40 places.
TEST_F(ThreeMf, ComponentsThatMultiply) {
    std::string objects = triangle_object;
    for (int i = 2; i < 42; ++i) {
        const std::string before = "<component objectid='" + std::to_string(i - 1) + "'/>";
        objects += "<object id='" + std::to_string(i) + "'><components>" + before + before + "</components></object>";
    }
    refuse_model(objects, "<item objectid='41'/>", "too many");
    refuse_model("<object id='1'><components><component objectid='1'/></components></object>", one_item, "too deeply");
}

TEST(ZipFile, SizesOf64Bits) {
    std::string bytes = stored_archive("a", "content");
    const std::size_t entry = bytes.find("PK\1\2");
    const std::string extra = little_endian(1, 2) + little_endian(16, 2) + little_endian(7, 8) + little_endian(7, 8);
    bytes.replace(entry + 20, 8, little_endian(0xffffffff, 4) + little_endian(0xffffffff, 4));
    bytes.replace(entry + 30, 2, little_endian(extra.size(), 2));
    bytes.insert(entry + 47, extra);
    EXPECT_EQ(ZipFile(bytes, "a.zip").read("a"), "content");
    bytes.replace(bytes.find(extra) + 12, 8, little_endian(~std::size_t(0), 8));
    expect_error(ErrorKind::user, {"a.zip", "part 'a' is cut off"},
                 [&] { static_cast<void>(ZipFile(bytes, "a.zip").read("a")); });
}

TEST(ZipFile, SizesAreChecked) {
    std::string bytes = stored_archive("a", "content");
    EXPECT_EQ(ZipFile(bytes, "a.zip").read("/A"), "content");
    EXPECT_EQ(ZipFile(bytes, "a.zip").read("b"), std::nullopt);
    const std::size_t entry = bytes.find("PK\1\2");
    bytes.replace(entry + 10, 2, little_endian(8, 2));
    bytes.replace(entry + 24, 4, little_endian(0xfffffff0, 4));
    expect_error(ErrorKind::user, {"a.zip", "part 'a' is damaged"},
                 [&] { static_cast<void>(ZipFile(bytes, "a.zip").read("a")); });
    bytes.replace(entry + 20, 4, little_endian(1000, 4));
    expect_error(ErrorKind::user, {"a.zip", "part 'a' is cut off"},
                 [&] { static_cast<void>(ZipFile(bytes, "a.zip").read("a")); });
}

}  // namespace
}  // namespace claray
