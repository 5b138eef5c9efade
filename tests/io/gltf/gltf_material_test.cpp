// glTF: materials, textures, and files that are broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "claray/io.hpp"
#include "host/io/image/ktx2_read.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/gltf_builder.hpp"
#include "tests/io/image/encoded_images.hpp"
#include "tests/support/process.hpp"

#if CLARAY_WITH_WEBP
#include <webp/encode.h>
#endif

namespace claray {
namespace {

using test::expect_error;
using test::from_base64;
using test::GltfBuilder;
using test::json;
using test::TemporaryFolder;

const std::string rgba_uri = std::string("data:image/png;base64,") + test::png_rgba;
const std::string palette_uri = std::string("data:image/png;base64,") + test::png_palette;

class GltfMaterial : public test::ReaderTest {
protected:
    GltfMaterial() { builder.triangle({{"material", 0}}); }

    Scene load(const json& material) {
        builder.root["materials"] = {material};
        warnings.clear();
        return load_gltf(folder.file("scene.gltf", builder.gltf()), warnings);
    }
    void refuse(const json& material, std::initializer_list<std::string> words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(load(material)); });
    }
    void texture_of_basis(const std::string& bytes) {
        static_cast<void>(folder.file("wall.ktx2", bytes));
        builder.root["images"] = json::array({{{"uri", "wall.ktx2"}, {"mimeType", "image/ktx2"}}});
        builder.root["textures"] = json::array({{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}});
        builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"KHR_texture_basisu"};
    }
    static json base_texture(const json& info) { return {{"pbrMetallicRoughness", {{"baseColorTexture", info}}}}; }

    GltfBuilder builder;
};

TEST_F(GltfMaterial, Factors) {
    const Material m =
        load({{"name", "paint"},
              {"doubleSided", true},
              {"emissiveFactor", {0.1, 0.2, 0.3}},
              {"alphaMode", "MASK"},
              {"alphaCutoff", 0.25},
              {"pbrMetallicRoughness",
               {{"baseColorFactor", {0.5, 0.25, 0.125, 0.75}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}}})
            .materials.at(0);
    EXPECT_EQ(m.name, "paint");
    EXPECT_EQ(m.kind, MaterialKind::principled);
    EXPECT_EQ(m.albedo, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(m.opacity, 0.75f);
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 0.25f);
    EXPECT_EQ(m.emission, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.25f);
    EXPECT_FALSE(m.cull_back);
    EXPECT_EQ(load({{"alphaMode", "BLEND"}}).materials.at(0).alpha_mode, AlphaMode::blend);
    EXPECT_EQ(load({{"alphaMode", "OPAQUE"}}).materials.at(0).alpha_mode, AlphaMode::opaque);
    EXPECT_EQ(load({{"name", "plain"}}).materials.at(0).ior, 1.5f);
}

TEST_F(GltfMaterial, Extensions) {
    const Material m =
        load({{"emissiveFactor", {1, 0.5, 0}},
              {"extensions",
               {{"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}},
                {"KHR_materials_ior", {{"ior", 1.33}}},
                {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
                {"KHR_materials_volume",
                 {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {0.1, 0.2, 0.3}}}},
                {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.25}}}}}})
            .materials.at(0);
    EXPECT_EQ(m.emission, glm::vec3(10, 5, 0));
    EXPECT_FLOAT_EQ(m.ior, 1.33f);
    EXPECT_FLOAT_EQ(m.transmission, 0.9f);
    EXPECT_FALSE(m.cull_back) << "rays leave a solid by its backs";
    EXPECT_EQ(m.attenuation, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.attenuation_distance, 2.f);
    EXPECT_EQ(m.clearcoat, 0.5f);
    EXPECT_EQ(m.clearcoat_roughness, 0.25f);
    EXPECT_FALSE(m.thin_walled);
    for (const json& volume : {json::object(), json{{"thicknessFactor", 0}}}) {
        const Scene pane =
            load({{"name", "pane"},
                  {"extensions",
                   {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_volume", volume}}}});
        EXPECT_TRUE(pane.materials.at(0).thin_walled);
        EXPECT_TRUE(pane.materials.at(0).cull_back) << "a wall has the sides that doubleSided says";
    }
    EXPECT_EQ(load({{"extensions", {{"KHR_materials_volume", json::object()}}}}).materials.at(0).attenuation_distance,
              0.f)
        << "infinite is none";
}

TEST_F(GltfMaterial, EveryTexture) {
    for (int i = 0; i < 7; ++i) builder.texture(rgba_uri);
    const auto t = [](int i) { return json{{"index", i}}; };
    const Scene scene =
        load({{"pbrMetallicRoughness", {{"baseColorTexture", t(0)}, {"metallicRoughnessTexture", t(1)}}},
              {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
              {"emissiveTexture", t(3)},
              {"emissiveFactor", {1, 1, 1}},
              {"occlusionTexture", t(6)},
              {"extensions",
               {{"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", t(4)}}},
                {"KHR_materials_clearcoat",
                 {{"clearcoatFactor", 1}, {"clearcoatTexture", t(5)}, {"clearcoatRoughnessTexture", t(6)}}}}}});
    const Material& m = scene.materials.at(0);
    ASSERT_EQ(scene.textures.size(), 7u);
    EXPECT_EQ(m.albedo_map.texture, 0u);
    EXPECT_EQ(scene.textures[0].format, TexelFormat::srgb8);
    EXPECT_EQ(scene.textures[m.metallic_roughness_map.texture].format, TexelFormat::linear8);
    EXPECT_EQ(scene.textures[m.normal_map.texture].format, TexelFormat::linear8);
    EXPECT_EQ(m.normal_scale, 0.5f);
    EXPECT_EQ(scene.textures[m.emission_map.texture].format, TexelFormat::srgb8);
    EXPECT_EQ(scene.textures[m.transmission_map.texture].format, TexelFormat::linear8);
    EXPECT_EQ(scene.textures[m.clearcoat_map.texture].format, TexelFormat::linear8);
    EXPECT_TRUE(m.clearcoat_roughness_map.used());
    EXPECT_EQ(scene.textures[0].bytes[3], 255u);
    EXPECT_EQ(scene.textures[0].bytes[13], 20u);
}

TEST_F(GltfMaterial, OnlyWhatIsReferencedIsDecoded) {
    builder.texture("data:image/png;base64,AAAA");
    builder.texture("gone.png");
    builder.texture(rgba_uri);
    const Scene scene = load({{"occlusionTexture", {{"index", 0}}},
                              {"emissiveTexture", {{"index", 1}}},  // times an emissive factor of 0
                              {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 2}}}}}});
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.materials.at(0).albedo_map.texture, 0u);
    EXPECT_FALSE(scene.materials.at(0).emission_map.used());
    builder.root["materials"] = {base_texture({{"index", 1}})};
    const Scene pose = load_gltf(folder.file("scene.gltf", builder.gltf()), warnings, {.images = false});
    EXPECT_EQ(pose.textures.at(pose.materials.at(0).albedo_map.texture).bytes, std::vector<std::uint8_t>(4, 255));
}

TEST_F(GltfMaterial, OneImageForAllWhoReadItAlike) {
    builder.texture(rgba_uri);
    builder.push("textures", {{"source", 0}});
    builder.push("textures", {{"source", 0}, {"sampler", builder.push("samplers", {{"wrapS", 33071}})}});
    builder.root["materials"] = json::array();
    const Scene scene = load(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}},
         {"emissiveTexture", {{"index", 1}}},
         {"emissiveFactor", {1, 1, 1}},
         {"normalTexture", {{"index", 2}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(scene.textures.size(), 3u);
    EXPECT_EQ(m.albedo_map.texture, m.emission_map.texture);
    EXPECT_NE(m.albedo_map.texture, m.metallic_roughness_map.texture) << "colour and numbers";
    EXPECT_NE(m.normal_map.texture, m.metallic_roughness_map.texture) << "another sampler";
}

TEST_F(GltfMaterial, Samplers) {
    builder.texture(rgba_uri, {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9987}});
    const auto load_texture = [&] { return load(base_texture({{"index", 0}})).textures.at(0); };
    EXPECT_EQ(load_texture().wrap_u, Wrap::clamp);
    EXPECT_EQ(load_texture().wrap_v, Wrap::mirror);
    EXPECT_EQ(load_texture().filter, Filter::nearest);
    builder.root["samplers"][0] = {{"magFilter", 9729}, {"minFilter", 9729}};
    EXPECT_EQ(load_texture().wrap_u, Wrap::repeat);
    EXPECT_EQ(load_texture().filter, Filter::bilinear);
    builder.root["samplers"][0] = {{"minFilter", 9985}};
    EXPECT_EQ(load_texture().filter, Filter::trilinear);
    builder.root["textures"][0].erase("sampler");
    EXPECT_EQ(load_texture().filter, Filter::trilinear) << "left to us";
    builder.root["textures"][0]["sampler"] = 5;
    refuse(base_texture({{"index", 0}}), {"texture 0 refers to sampler 5 of 1"});
    builder.root["textures"][0]["sampler"] = 0;
    builder.root["samplers"][0] = {{"wrapS", 1}};
    refuse(base_texture({{"index", 0}}), {"wrap mode 1"});
}

TEST_F(GltfMaterial, TextureTransformAndSecondCoordinates) {
    builder.texture(rgba_uri);
    json info = {
        {"index", 0},
        {"texCoord", 1},
        {"extensions", {{"KHR_texture_transform", {{"offset", {0.25, 0.5}}, {"rotation", 1.5}, {"scale", {2, 3}}}}}}};
    const TextureUse use = load(base_texture(info)).materials.at(0).albedo_map;
    EXPECT_EQ(use.uv_set, 1u);
    EXPECT_EQ(use.offset, glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(use.scale, glm::vec2(2.f, 3.f));
    EXPECT_EQ(use.rotation, 1.5f);
    info["extensions"]["KHR_texture_transform"]["texCoord"] = 0;
    EXPECT_EQ(load(base_texture(info)).materials.at(0).albedo_map.uv_set, 0u) << "the extension wins";
    // In an extension's own texture too.
    info["extensions"]["KHR_texture_transform"]["texCoord"] = 1;
    const Material m =
        load({{"extensions",
               {{"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", info}}}}}})
            .materials.at(0);
    EXPECT_EQ(m.transmission_map.uv_set, 1u);
    EXPECT_EQ(m.transmission_map.scale, glm::vec2(2.f, 3.f));
}

/// Each material chooses two of all sets of coordinates.
TEST_F(GltfMaterial, AnyTwoSetsOfCoordinates) {
    builder.texture(rgba_uri);
    json& attributes = builder.root["meshes"][0]["primitives"][0]["attributes"];
    for (const int set : {0, 1, 2, 3})
        attributes["TEXCOORD_" + std::to_string(set)] =
            builder.accessor<float>("VEC2", std::vector<float>(6, float(set)));
    const auto sets = [&](int base, int normal, int emissive) {
        const auto texture = [](int set) { return json{{"index", 0}, {"texCoord", set}}; };
        const Scene scene = load({{"pbrMetallicRoughness", {{"baseColorTexture", texture(base)}}},
                                  {"normalTexture", texture(normal)},
                                  {"emissiveFactor", {1, 1, 1}},
                                  {"emissiveTexture", texture(emissive)}});
        const Mesh& mesh = scene.meshes.at(0);
        const Material& m = scene.materials.at(0);
        std::vector<float> found;
        for (const TextureUse& use : {m.albedo_map, m.normal_map, m.emission_map})
            found.push_back(!use.used() ? -1.f : (use.uv_set == 0 ? mesh.uvs : mesh.uvs1).at(0).x);
        return found;
    };
    EXPECT_EQ(sets(0, 1, 1), (std::vector<float>{0, 1, 1}));
    EXPECT_EQ(sets(1, 0, 1), (std::vector<float>{1, 0, 1}));
    EXPECT_EQ(sets(2, 0, 2), (std::vector<float>{2, 0, 2}));
    EXPECT_EQ(sets(3, 1, 3), (std::vector<float>{3, 1, 3}));
    EXPECT_EQ(warned("left out"), 0u);
    EXPECT_EQ(sets(3, 2, 1), (std::vector<float>{3, 2, -1}));
    EXPECT_EQ(warned("a texture with coordinates TEXCOORD_1 is left out, a material has at most two sets"), 1u);
}

TEST_F(GltfMaterial, TangentsAreReadForNormalMaps) {
    builder.texture(rgba_uri);
    json& attributes = builder.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["TANGENT"] = builder.accessor<float>("VEC4", {2, 0, 0, 1, 0, 1, 0, -1, 0, 1, 0, 1});
    const json material = {{"normalTexture", {{"index", 0}}}};
    EXPECT_TRUE(load(material).meshes.at(0).tangents.empty()) << "without normals they are ignored";
    attributes["NORMAL"] = builder.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    builder.root["nodes"][0]["scale"] = {3, 1, -1};
    const std::vector<glm::vec4> tangents = load(material).meshes.at(0).tangents;
    EXPECT_EQ(tangents, (std::vector<glm::vec4>{{1, 0, 0, -1}, {0, 1, 0, 1}, {0, 1, 0, -1}})) << "mirrored";
    const json brushed = {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 1}}}}}};
    const json coated = {
        {"extensions",
         {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", {{"index", 0}}}}}}}};
    EXPECT_EQ(load(brushed).meshes.at(0).tangents, tangents);
    EXPECT_EQ(load(coated).meshes.at(0).tangents, tangents);
}

TEST_F(GltfMaterial, ImagesInBuffersAndFiles) {
    const int view = builder.view(from_base64(test::png_palette));
    builder.push("images", {{"bufferView", view}, {"mimeType", "image/png"}, {"name", "inner"}});
    builder.push("images", {{"uri", "my%20image.png"}});
    builder.push("textures", {{"source", 0}});
    builder.push("textures", {{"source", 1}});
    static_cast<void>(folder.file("my image.png", from_base64(test::png_rgba)));
    EXPECT_EQ(load(base_texture({{"index", 0}})).textures.at(0).bytes[0], 200u);
    EXPECT_EQ(load(base_texture({{"index", 0}})).textures.at(0).name, "inner");
    EXPECT_EQ(load(base_texture({{"index", 1}})).textures.at(0).bytes[13], 20u);
    EXPECT_EQ(load_gltf(folder.file("scene.glb", builder.glb()), warnings).textures.at(0).bytes[13], 20u);
}

/// The plain image of a texture stands in for one that can't be decoded.
TEST_F(GltfMaterial, OtherContainersOfImages) {
    builder.texture(palette_uri);
    builder.push("images", {{"uri", "never-opened.ktx2"}, {"mimeType", "image/ktx2"}});
    json& texture = builder.root["textures"][0];
    for (const char* extension : {"EXT_texture_avif", "MSFT_texture_dds"}) {
        texture = {{"source", 0}, {"extensions", {{extension, {{"source", 1}}}}}};
        builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {extension};
        EXPECT_EQ(load(base_texture({{"index", 0}})).textures.at(0).bytes[0], 200u) << extension;
        for (const std::string& line : warnings) EXPECT_EQ(line.find(extension), std::string::npos) << line;
        texture.erase("source");
        refuse(base_texture({{"index", 0}}), {"scene.gltf", "texture 0", extension, "PNG or JPEG"});
    }
}

/// libktx is found while the program runs, if at all.
TEST_F(GltfMaterial, BasisImages) {
    const std::string bytes =
        test::read_file(std::filesystem::path(CLARAY_SOURCE_DIR) / "tests/fuzz/corpus/image/basis.ktx2");
    texture_of_basis(bytes);
    const json use = base_texture({{"index", 0}});
    if (!can_read_ktx2()) {
        refuse(use, {"wall.ktx2", "KHR_texture_basisu", "libktx is not installed", "CLARAY_KTX"});
        GTEST_SKIP() << "libktx is not installed";
    }
    const Texture texture = load(use).textures.at(0);
    ASSERT_EQ(texture.width, 16u);
    ASSERT_EQ(texture.height, 8u);
    ASSERT_EQ(texture.channels, 4u);
    const auto texel = [&](unsigned x, unsigned y) { return &texture.bytes[4 * (y * 16 + x)]; };
    EXPECT_NEAR(texel(2, 2)[0], 200, 12) << "red at the top left";
    EXPECT_NEAR(texel(13, 2)[1], 200, 12) << "green at the top right";
    EXPECT_NEAR(texel(2, 6)[2], 200, 12) << "blue at the bottom left";
    EXPECT_EQ(texel(2, 2)[3], 255);
    for (const std::size_t kept : {12u, 60u, 100u}) {
        texture_of_basis(bytes.substr(0, kept));
        refuse(use, {"wall.ktx2"});
    }
}

#if CLARAY_WITH_WEBP
TEST_F(GltfMaterial, WebpImages) {
    const std::vector<std::uint8_t> pixels = {10, 20, 30, 40, 50, 60};
    std::uint8_t* encoded = nullptr;
    const std::size_t size = WebPEncodeLosslessRGB(pixels.data(), 2, 1, 6, &encoded);
    const std::string bytes(reinterpret_cast<const char*>(encoded), size);
    WebPFree(encoded);
    builder.texture(palette_uri);
    json& texture = builder.root["textures"][0];
    builder.root["extensionsUsed"] = builder.root["extensionsRequired"] = {"EXT_texture_webp"};
    texture["extensions"]["EXT_texture_webp"]["source"] =
        builder.push("images", {{"bufferView", builder.view(bytes)}, {"mimeType", "image/webp"}});
    EXPECT_EQ(load(base_texture({{"index", 0}})).textures.at(0).bytes, pixels);
    builder.root["images"][1] = {{"uri", "data:image/webp;base64," + test::base64(bytes)}};
    EXPECT_EQ(load(base_texture({{"index", 0}})).textures.at(0).bytes, pixels);
    texture["extensions"]["EXT_texture_webp"]["source"] = 7;
    refuse(base_texture({{"index", 0}}), {"texture 0 refers to image 7 of 2"});
}
#endif

TEST_F(GltfMaterial, BadTextures) {
    builder.texture("gone.png");
    const auto with = [&](const json& image, std::initializer_list<std::string> words) {
        builder.root["images"][0] = image;
        refuse(base_texture({{"index", 0}}), words);
    };
    const std::string good = from_base64(test::png_rgba);
    static_cast<void>(folder.file("cut.png", good.substr(0, 50)));
    with({{"uri", "cut.png"}}, {"cut.png", "cut off"});
    static_cast<void>(folder.file("text.png", "not an image"));
    with({{"uri", "text.png"}}, {"text.png", "not a PNG"});
    with({{"uri", "data:image/png;base64,aGVsbG8="}, {"name", "broken"}}, {"image 'broken'", "not a PNG"});
    with({{"bufferView", 0}, {"mimeType", "image/png"}}, {"image 0", "not a PNG"});
    std::string huge = good;
    huge[18] = 0x50;  // 20482 pixels wide; the checksum is wrong too
    static_cast<void>(folder.file("huge.png", huge));
    with({{"uri", "huge.png"}}, {"huge.png"});
    builder.root["textures"][0]["source"] = 9;
    refuse(base_texture({{"index", 0}}), {"texture 0 refers to image 9 of 1"});
    refuse(base_texture({{"index", 4}}), {"material 0 refers to texture 4 of 1"});
}

TEST_F(GltfMaterial, MissingTexturesAreGrey) {
    builder.texture("gone.png");
    const auto with = [&](const json& image, const char* why) {
        builder.root["images"][0] = image;
        const Material m = load(base_texture({{"index", 0}})).materials.at(0);
        EXPECT_EQ(m.albedo, glm::vec3(0.5f)) << image;
        EXPECT_FALSE(m.albedo_map.used()) << image;
        EXPECT_EQ(warned(why), 1u) << image;
        EXPECT_EQ(warned("grey"), 1u) << image;
    };
    with({{"uri", "gone.png"}}, "scene.gltf': the image 'gone.png' is missing");
    with({{"uri", "../up.png"}}, "'../up.png' leaves the scene's folder");
    with({{"uri", "%2E%2E%2Fup.png"}}, "'../up.png' leaves the scene's folder");
    with({{"uri", "/etc/passwd"}}, "absolute");
    with({{"uri", "https://x.org/a.png"}}, "URL");
    with({{"name", "nowhere"}}, "is empty");
    builder.root["textures"][0].erase("source");
    with({{"uri", "gone.png"}}, "texture 0 has no image");
    builder.root["textures"][0]["source"] = 0;
    static_cast<void>(folder.file("gone.png", from_base64(test::png_rgba)));
    builder.root["images"][0] = {{"uri", "maps/gone.png"}};
    EXPECT_TRUE(load(base_texture({{"index", 0}})).materials.at(0).albedo_map.used()) << "it lies beside the file";
    EXPECT_EQ(warned("'maps/gone.png' is missing: '"), 1u);
    builder.root["images"][0] = {{"uri", "no.png"}};
    json lamp = {{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}, {"normalTexture", {{"index", 0}}}};
    const Material m = load(lamp).materials.at(0);
    EXPECT_EQ(m.emission, glm::vec3(0.f)) << "the image would say where it shines";
    EXPECT_EQ(m.albedo, glm::vec3(1.f));
    EXPECT_FALSE(m.normal_map.used());
}

TEST_F(GltfMaterial, DataUrisOfEveryForm) {
    const std::string data = test::base64(from_base64(test::png_rgba));
    std::string for_urls = data, escaped;
    std::replace(for_urls.begin(), for_urls.end(), '+', '-'), std::replace(for_urls.begin(), for_urls.end(), '/', '_');
    while (for_urls.ends_with('=')) for_urls.pop_back();
    for (const char c : data) escaped += c == '+' ? "%2B" : c == '/' ? "%2f" : c == '=' ? "%3D" : std::string(1, c);
    builder.texture("");
    for (const std::string& uri :
         {"data:;base64," + data, "data:image/png;charset=utf-8;base64," + data, "data:image/x-png;base64," + data,
          "DATA:image/png;BASE64," + data, "data:image/png;base64," + for_urls, "data:;base64," + escaped,
          "data:image/png;base64,\n" + data.substr(0, 20) + "\n " + data.substr(20)}) {
        builder.root["images"][0] = {{"uri", uri}};
        EXPECT_EQ(load(base_texture({{"index", 0}})).textures.size(), 1u) << uri;
        EXPECT_EQ(warned("image"), 0u) << uri;
    }
    builder.root["images"][0] = {{"uri", "data:;base64,*" + data}, {"name", "bad"}};
    refuse(base_texture({{"index", 0}}), {"image 'bad'", "base64", "damaged"});
}

TEST_F(GltfMaterial, BadValues) {
    refuse({{"name", "paint"}, {"pbrMetallicRoughness", {{"metallicFactor", -0.5}}}},
           {"scene.gltf", "material 'paint'", "metallic is not in 0..1"});
    refuse({{"pbrMetallicRoughness", {{"roughnessFactor", 2}}}}, {"roughness"});
    refuse({{"pbrMetallicRoughness", {{"baseColorFactor", {-1, 0, 0, 1}}}}}, {"albedo"});
    refuse({{"emissiveFactor", {1e300, 0, 0}}}, {"emission"});
    refuse({{"alphaMode", "GLASS"}}, {"material 0", "'GLASS'"});
    refuse({{"extensions", {{"KHR_materials_ior", {{"ior", -1}}}}}}, {"refraction"});
    refuse({{"extensions", {{"KHR_materials_volume", {{"attenuationDistance", -1}}}}}}, {"attenuation distance"});
    refuse({{"extensions", {{"KHR_materials_sheen", {{"sheenColorFactor", {2, 0, 0}}}}}}}, {"sheen colour"});
    refuse({{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 1.5}}}}}}, {"anisotropy"});
    refuse({{"extensions", {{"KHR_materials_iridescence", {{"iridescenceFactor", 1}, {"iridescenceIor", 0}}}}}},
           {"refraction of its iridescence"});
    refuse({{"extensions", {{"KHR_materials_specular", {{"specularFactor", -1}}}}}}, {"specular weight"});
}

/// An index of refraction of 0 stands for a dielectric that reflects all light, times KHR_materials_specular's colour.
TEST_F(GltfMaterial, NoIndexOfRefractionLeavesTheReflectanceToSpecular) {
    const auto with = [](const json& others) {
        json extensions = {{"KHR_materials_ior", {{"ior", 0}}}};
        extensions.update(others);
        return json{{"name", "old"}, {"extensions", extensions}};
    };
    Material m = load(with({{"KHR_materials_specular", {{"specularColorFactor", {0.5, 0.04, 0}}}}})).materials.at(0);
    EXPECT_EQ(m.ior, 1.5f);
    EXPECT_NEAR(m.specular_tint.x, 12.5f, 1e-5);
    EXPECT_NEAR(m.specular_tint.y, 1.f, 1e-6);
    EXPECT_EQ(std::count_if(warnings.begin(), warnings.end(), [](auto& w) { return w.find("refraction") != w.npos; }),
              0);
    m = load(with({{"KHR_materials_transmission", {{"transmissionFactor", 1}}}})).materials.at(0);
    EXPECT_NE(warnings.at(0).find("index of refraction of 0"), std::string::npos);
}

TEST_F(GltfMaterial, Layers) {
    for (int i = 0; i < 9; ++i) builder.texture(rgba_uri);
    const auto t = [](int i) { return json{{"index", i}}; };
    const Scene scene =
        load({{"name", "layers"},
              {"extensions",
               {{"KHR_materials_specular",
                 {{"specularFactor", 0.5},
                  {"specularColorFactor", {1, 2, 3}},
                  {"specularTexture", t(0)},
                  {"specularColorTexture", t(1)}}},
                {"KHR_materials_sheen",
                 {{"sheenColorFactor", {0.1, 0.2, 0.3}},
                  {"sheenRoughnessFactor", 0.4},
                  {"sheenColorTexture", t(2)},
                  {"sheenRoughnessTexture", t(3)}}},
                {"KHR_materials_anisotropy",
                 {{"anisotropyStrength", 0.6}, {"anisotropyRotation", -1.5}, {"anisotropyTexture", t(4)}}},
                {"KHR_materials_iridescence",
                 {{"iridescenceFactor", 0.7},
                  {"iridescenceIor", 1.8},
                  {"iridescenceThicknessMinimum", 150},
                  {"iridescenceThicknessMaximum", 900},
                  {"iridescenceTexture", t(5)},
                  {"iridescenceThicknessTexture", t(6)}}},
                {"KHR_materials_clearcoat",
                 {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", {{"index", 7}, {"scale", 0.3}}}}}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.kind, MaterialKind::principled);
    EXPECT_EQ(m.specular_weight, 0.5f);
    EXPECT_EQ(m.specular_tint, glm::vec3(1, 2, 3));
    EXPECT_EQ(m.sheen, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.sheen_roughness, 0.4f);
    EXPECT_EQ(m.anisotropy, 0.6f);
    EXPECT_EQ(m.anisotropy_rotation, -1.5f);
    EXPECT_EQ(m.iridescence, 0.7f);
    EXPECT_EQ(m.iridescence_ior, 1.8f);
    EXPECT_EQ(m.film_thickness, glm::vec2(150, 900));
    EXPECT_EQ(m.clearcoat_normal_scale, 0.3f);
    const auto format = [&](const TextureUse& use) { return scene.textures.at(use.texture).format; };
    EXPECT_EQ(format(m.specular_map), TexelFormat::srgb8);
    EXPECT_EQ(format(m.sheen_map), TexelFormat::srgb8);
    for (const TextureUse* use : {&m.specular_weight_map, &m.sheen_roughness_map, &m.anisotropy_map, &m.iridescence_map,
                                  &m.film_thickness_map, &m.clearcoat_normal_map})
        EXPECT_EQ(format(*use), TexelFormat::linear8);
    const std::vector<TextureUse> uses = {m.specular_weight_map, m.specular_map,        m.sheen_map,
                                          m.sheen_roughness_map, m.anisotropy_map,      m.iridescence_map,
                                          m.film_thickness_map,  m.clearcoat_normal_map};
    for (std::size_t i = 0; i < uses.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) EXPECT_NE(uses[i].texture, uses[k].texture) << i << " and " << k;
    EXPECT_EQ(load({{"extensions", {{"KHR_materials_sheen", json::object()}}}}).materials.at(0).sheen, glm::vec3(0.f));
    const Material film =
        load({{"extensions", {{"KHR_materials_iridescence", {{"iridescenceFactor", 1}}}}}}).materials.at(0);
    EXPECT_EQ(film.iridescence_ior, 1.3f);
    EXPECT_EQ(film.film_thickness, glm::vec2(100, 400));
}

TEST_F(GltfMaterial, UnlitIsItsBaseColor) {
    const Material m = load({{"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}}},
                             {"alphaMode", "BLEND"},
                             {"emissiveFactor", {1, 1, 1}},
                             {"extensions", {{"KHR_materials_unlit", json::object()}}}})
                           .materials.at(0);
    EXPECT_EQ(m.kind, MaterialKind::unlit);
    EXPECT_EQ(m.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.opacity, 0.4f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
    EXPECT_EQ(m.emission, glm::vec3(0.f));
}

TEST_F(GltfMaterial, SpecularGlossinessIsConverted) {
    builder.texture(rgba_uri);  // its alpha: 255 but for the last texel
    const Scene scene = load({{"extensions",
                               {{"KHR_materials_pbrSpecularGlossiness",
                                 {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                  {"specularFactor", {0.04, 0.5, 1}},
                                  {"glossinessFactor", 0.75},
                                  {"specularGlossinessTexture", {{"index", 0}}}}}}}});
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.kind, MaterialKind::principled);
    EXPECT_EQ(m.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.opacity, 0.4f);
    EXPECT_EQ(m.metallic, 0.f);
    EXPECT_NEAR(m.specular_tint.x, 1.f, 1e-6);
    EXPECT_NEAR(m.specular_tint.y, 12.5f, 1e-5);
    EXPECT_EQ(scene.textures.at(m.specular_map.texture).format, TexelFormat::srgb8);
    const Texture& rough = scene.textures.at(m.metallic_roughness_map.texture);
    const Texture& gloss = scene.textures.at(m.specular_map.texture);
    ASSERT_EQ(rough.channels, 3u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(rough.bytes.at(3 * i + 1), 255 - 0.75 * gloss.bytes.at(4 * i + 3), 0.51) << i;
    const Material plain =
        load({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"glossinessFactor", 0.25}}}}}}).materials.at(0);
    EXPECT_EQ(plain.roughness, 0.75f);
    EXPECT_EQ(plain.albedo, glm::vec3(1.f));
}

/// Whatever happens to the bytes, the result is a sound scene or one line.
void load_broken(const TemporaryFolder& folder, const std::string& name, const std::string& bytes) {
    const auto path = folder.file(name, bytes);
    try {
        Warnings warnings;
        validate(load_gltf(path, warnings));
        for (const std::string& line : warnings) EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
}

TEST_F(GltfMaterial, BrokenFilesNeverCrash) {
    builder.texture(palette_uri);
    builder.push("images", {{"bufferView", builder.view(from_base64(test::png_rgba))}, {"mimeType", "image/png"}});
    builder.push("textures", {{"source", 1}});
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
    builder.root["nodes"][0]["camera"] = 0;
    builder.root["nodes"][0]["rotation"] = {0, 0, 0, 1};
    builder.root["meshes"][0]["primitives"][0]["indices"] = builder.accessor<std::uint16_t>("SCALAR", {0, 1, 2});
    static_cast<void>(load({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                            {"normalTexture", {{"index", 1}}},
                            {"extensions", {{"KHR_materials_ior", {{"ior", 1.4}}}}}}));
    const std::string glb = builder.glb(), gltf = builder.gltf();
    EXPECT_NO_THROW(static_cast<void>(load_gltf(folder.file("whole.glb", glb), warnings)));
    for (std::size_t size = 0; size < glb.size(); ++size) {
        const auto path = folder.file("cut.glb", glb.substr(0, size));
        expect_error(ErrorKind::user, {"cut.glb"}, [&] { static_cast<void>(load_gltf(path, warnings)); });
    }
    std::minstd_rand random(7);
    for (int trial = 0; trial < 3000; ++trial) {
        std::string broken = trial % 2 ? glb : gltf;
        for (unsigned flips = 1 + random() % 3; flips > 0; --flips) {
            // Digits become other digits more often than by chance, so that numbers go wrong in valid JSON.
            char& c = broken[random() % broken.size()];
            c = c >= '0' && c <= '9' && random() % 2 ? char('0' + random() % 10) : char(random() >> 8);
        }
        load_broken(folder, trial % 2 ? "broken.glb" : "broken.gltf", broken);
    }
}

}  // namespace
}  // namespace claray
