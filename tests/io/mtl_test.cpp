// MTL: which of claray's materials a description becomes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/base64.hpp"
#include "tests/io/image/encoded_images.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::from_base64;

const std::string one_face = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class Mtl : public test::ReaderTest {
protected:
    Scene load(const std::string& mtl, const std::string& faces) {
        static_cast<void>(folder.file("m.mtl", mtl));
        Scene scene = load_obj(folder.file("mesh.obj", "mtllib m.mtl\n" + one_face + faces), warnings);
        validate(scene);
        return scene;
    }
    Material load(const std::string& description) {
        return load("newmtl a\n" + description + "\n", "usemtl a\nf 1 2 3\n").materials.at(0);
    }
};

TEST_F(Mtl, DiffuseIsLambert) {
    const Material m = load("Kd 0.1 0.2 0.3\nKs 0.5 0.5 0.5\nNs 96\nillum 1");
    EXPECT_EQ(m.kind, MaterialKind::lambert);
    EXPECT_EQ(m.name, "a");
    EXPECT_EQ(m.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.emission, glm::vec3(0.f));
    EXPECT_EQ(warned("a"), warned("added a neutral studio as light")) << warnings.at(0);
}

TEST_F(Mtl, HighlightIsBlinnPhong) {
    for (const std::string illumination : {"\nillum 2", ""}) {  // 2 where the file does not say
        const Material m = load("Kd 0.1 0.2 0.3\nKs 0.5 0.25 1\nNs 96" + illumination);
        EXPECT_EQ(m.kind, MaterialKind::blinn_phong) << illumination;
        EXPECT_EQ(m.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
        EXPECT_EQ(m.specular, glm::vec3(0.5f, 0.25f, 1.f));
        EXPECT_EQ(m.shininess, 96.f);
    }
    EXPECT_EQ(load("Kd 1 1 1\nKs 0 0 0\nNs 96\nillum 2").kind, MaterialKind::lambert);
    for (const std::string illumination : {"0", "1"})
        EXPECT_EQ(load("Kd 1 1 1\nKs 1 1 1\nNs 96\nillum " + illumination).kind, MaterialKind::lambert);
    EXPECT_EQ(load("Kd 1 1 1\nKs 1 1 1\nPm 0.5\nillum 2").kind, MaterialKind::principled);
    warnings.clear();
    const Material wild = load("Kd 1 1 1\nKs 3 1 1\nNs -5\nillum 2");
    EXPECT_EQ(wild.specular, glm::vec3(1.f));
    EXPECT_EQ(wild.shininess, 0.f);
    EXPECT_EQ(warned("values out of range were clamped"), 1u);
    const Scene two = load("newmtl a\nKd 1 1 1\nKs 1 1 1\nnewmtl b\nKd 1 1 1\nKs 1 1 1\nillum 1\n",
                           "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    EXPECT_EQ(two.materials.at(0).kind, MaterialKind::blinn_phong) << "the other's illum is not its own";
    EXPECT_EQ(two.materials.at(1).kind, MaterialKind::lambert);
}

TEST_F(Mtl, WhatIsNoNumberIsAWarningThatNamesTheLine) {
    EXPECT_EQ(load("Ka 1 1 1\nKd 0.5 x 0.5").albedo, glm::vec3(0.5f, 0.f, 0.5f));
    EXPECT_EQ(warned("m.mtl line 3: 'x' is not a valid number for a material: 0 is used"), 1u);
    for (const std::string line : {"Ni nan", "Pr inf", "Ns", "illum two", "Tf spectral a.rfl", "d 0,5", "Ke 1 1 0x1"}) {
        warnings.clear();
        load(line);
        EXPECT_EQ(warned("m.mtl line 2: "), line == "Ns" ? 0u : 1u) << line;
    }
    warnings.clear();
    load("Kd 1 .5 1e-3 # pale\nNs +20.\nd -halo 0.5\nillum 2\nother x\nTr 0");
    EXPECT_EQ(warned("is not a valid number"), 0u);
}

TEST_F(Mtl, OneNumberIsGrey) {
    for (const char* line : {"Kd 0.25", "Kd 0.25  # dim", "\tKd\t.25"})
        EXPECT_EQ(load(line).albedo, glm::vec3(0.25f)) << line;
}

TEST_F(Mtl, EmissionLightsTheSceneWithoutSky) {
    const Scene scene = load("newmtl a\nKe 17 12 4\n", "usemtl a\nf 1 2 3\n");
    EXPECT_EQ(scene.materials.at(0).emission, glm::vec3(17.f, 12.f, 4.f));
    EXPECT_EQ(scene.sky.zenith, glm::vec3(0.f));
    EXPECT_TRUE(warnings.empty());
}

TEST_F(Mtl, TransparentIsGlass) {
    const Material by_model = load("Kd 0.1 0.1 0.1\nTf 0.9 1 0.8\nNi 1.7\nillum 7");
    EXPECT_EQ(by_model.kind, MaterialKind::glass);
    EXPECT_EQ(by_model.albedo, glm::vec3(0.9f, 1.f, 0.8f));
    EXPECT_FLOAT_EQ(by_model.ior, 1.7f);
    const Material by_dissolve = load("Kd 0.1 0.1 0.1\nd 0.1");
    EXPECT_EQ(by_dissolve.kind, MaterialKind::glass);
    EXPECT_EQ(by_dissolve.albedo, glm::vec3(1.f));
    EXPECT_FLOAT_EQ(by_dissolve.ior, 1.5f);
    EXPECT_EQ(load("Kd 0.1 0.1 0.1\nd 0.9").kind, MaterialKind::lambert);
    EXPECT_EQ(load("Kd 0.1 0.1 0.1\nTr 0.9").kind, MaterialKind::glass);
}

TEST_F(Mtl, ReflectingIsMirrorOrMetalByItsExponent) {
    const Material sharp = load("Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 1000\nillum 3");
    EXPECT_EQ(sharp.kind, MaterialKind::mirror);
    EXPECT_EQ(sharp.albedo, glm::vec3(0.9f, 0.8f, 0.7f));
    const Material dull = load("Ks 0.9 0.8 0.7\nNs 30\nillum 5");
    EXPECT_EQ(dull.kind, MaterialKind::metal);
    EXPECT_NEAR(dull.roughness, std::sqrt(0.25), 1e-6);  // alpha = sqrt(2 / 32)
    EXPECT_EQ(load("Ks 0.9 0.8 0.7\nNs 30\nillum 2").kind, MaterialKind::metal) << "Ks alone";
}

TEST_F(Mtl, MetallicIsMetal) {
    const Material gold = load("Kd 1 0.7 0.3\nPm 1\nPr 0.4");
    EXPECT_EQ(gold.kind, MaterialKind::metal);
    EXPECT_EQ(gold.albedo, glm::vec3(1.f, 0.7f, 0.3f));
    EXPECT_FLOAT_EQ(gold.roughness, 0.4f);
    EXPECT_EQ(load("Kd 1 0.7 0.3\nPm 1\nPr 0").kind, MaterialKind::mirror);
}

TEST_F(Mtl, ValuesOutOfRangeAreMovedAndReported) {
    const Material m = load("Kd 2 -1 0.5\nKe 1e39 0 5");
    EXPECT_EQ(m.albedo, glm::vec3(1.f, 0.f, 0.5f));
    EXPECT_EQ(m.emission, glm::vec3(0.f, 0.f, 5.f));
    EXPECT_EQ(warned("'a': values out of range"), 1u);
}

TEST_F(Mtl, EveryFaceKeepsItsMaterial) {
    const Scene scene = load("newmtl unused\nKd 1 1 1\nnewmtl red one\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n",
                             "f 1 2 3\nusemtl blue \nf 1 2 3\nf 1 3 2\nusemtl red one\nf 1 2 3\n"
                             "usemtl nowhere\nf 1 2 3\nf 1 2 3\n");
    const std::vector<std::uint32_t>& used = scene.meshes.at(0).materials;
    ASSERT_EQ(used.size(), 6u);
    ASSERT_EQ(scene.materials.size(), 4u) << "unused ones are left out";
    EXPECT_EQ(scene.materials[used[0]].albedo, glm::vec3(0.7f));
    EXPECT_EQ(scene.materials[used[1]].name, "blue");
    EXPECT_EQ(used[1], used[2]);
    EXPECT_EQ(scene.materials[used[3]].name, "red one");
    EXPECT_EQ(scene.materials[used[3]].albedo, glm::vec3(1.f, 0.f, 0.f));
    EXPECT_EQ(scene.materials[used[4]].albedo, glm::vec3(0.7f));
    EXPECT_EQ(warned("'nowhere' is not defined"), 1u);
}

TEST_F(Mtl, MissingFileIsAWarningAndGrey) {
    const Scene scene =
        load_obj(folder.file("mesh.obj", "mtllib gone.mtl\n" + one_face + "usemtl a\nf 1 2 3\n"), warnings);
    EXPECT_EQ(warned("gone.mtl' is missing"), 1u);
    EXPECT_EQ(warned("not defined"), 0u) << "one warning is enough";
    EXPECT_EQ(scene.materials.at(0).kind, MaterialKind::lambert);
    EXPECT_EQ(scene.materials.at(0).albedo, glm::vec3(0.7f));
}

TEST_F(Mtl, EmptyFileIsGrey) { EXPECT_EQ(load("", "usemtl a\nf 1 2 3\n").materials.at(0).albedo, glm::vec3(0.7f)); }

TEST_F(Mtl, SeveralFilesAndNamesWithBlanks) {
    static_cast<void>(folder.file("a.mtl", "newmtl a\nKd 1 0 0\n"));
    static_cast<void>(folder.file("b.mtl", "newmtl b\nKd 0 1 0\n"));
    static_cast<void>(folder.file("of mine.mtl", "newmtl c\nKd 0 0 1\n"));
    const Scene scene =
        load_obj(folder.file("mesh.obj", "mtllib a.mtl b.mtl gone.mtl\nmtllib of mine.mtl\n" + one_face +
                                             "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n"),
                 warnings);
    ASSERT_EQ(scene.materials.size(), 3u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.materials[std::size_t(i)].albedo[i], 1.f);
    EXPECT_EQ(warned("is missing"), 1u);
}

TEST_F(Mtl, PhysicalKeysArePrincipled) {
    const Material mixed = load("Kd 1 0.7 0.3\nPm 0.2\nPr 0.4");
    EXPECT_EQ(mixed.kind, MaterialKind::principled);
    EXPECT_EQ(mixed.albedo, glm::vec3(1.f, 0.7f, 0.3f));
    EXPECT_EQ(mixed.metallic, 0.2f);
    EXPECT_EQ(mixed.roughness, 0.4f);
    EXPECT_EQ(mixed.ior, 1.5f);
    const Material coated = load("Kd 1 0 0\nPc 0.5\nPcr 0.25\nNi 1.4\nNs 30");
    EXPECT_EQ(coated.kind, MaterialKind::principled);
    EXPECT_EQ(coated.clearcoat, 0.5f);
    EXPECT_EQ(coated.clearcoat_roughness, 0.25f);
    EXPECT_EQ(coated.ior, 1.4f);
    EXPECT_NEAR(coated.roughness, 0.5, 1e-6) << "by the exponent where there is no Pr";
    EXPECT_EQ(load("Kd 1 0 0\nPm 1\nPr 0.4\nPc 1").kind, MaterialKind::principled) << "a coated metal";
    const Material frosted = load("Kd 1 1 1\nPr 0.5\nillum 7");
    EXPECT_EQ(frosted.kind, MaterialKind::glass);
    EXPECT_EQ(frosted.roughness, 0.5f);
    EXPECT_EQ(load("Kd 1 1 1\nillum 7").roughness, 0.f) << "glass is smooth unless it says otherwise";
}

TEST_F(Mtl, DissolvedIsTranslucent) {
    const Material m = load("Kd 0.1 0.1 0.1\nd 0.75");
    EXPECT_EQ(m.opacity, 0.75f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
    EXPECT_EQ(load("Kd 0.1 0.1 0.1\nd 1").alpha_mode, AlphaMode::opaque);
}

class MtlMap : public Mtl {
protected:
    MtlMap() {
        static_cast<void>(folder.file("rgba.png", from_base64(test::png_rgba)));
        static_cast<void>(folder.file("pal.png", from_base64(test::png_palette)));
    }
    Scene scene(const std::string& description) {
        return Mtl::load("newmtl a\n" + description + "\n", "vt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n");
    }
    void grey(const std::string& name, unsigned width, const std::vector<std::uint8_t>& bytes, unsigned channels = 1) {
        Texture t;
        t.width = width, t.height = unsigned(bytes.size()) / width / channels, t.channels = channels, t.bytes = bytes;
        write_texture(folder / name, t);
    }
    void refuse(const std::string& description, std::initializer_list<std::string> words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(scene(description)); });
    }
    using Bytes = std::vector<std::uint8_t>;
};

TEST_F(MtlMap, Color) {
    const Scene s = scene("Kd 0.5 0.5 0.5\nmap_Kd rgba.png");
    EXPECT_EQ(s.materials.at(0).kind, MaterialKind::lambert);
    EXPECT_EQ(s.materials[0].albedo, glm::vec3(0.5f));
    ASSERT_EQ(s.textures.size(), 1u);
    EXPECT_EQ(s.textures[0].format, TexelFormat::srgb8);
    EXPECT_EQ(s.textures[0].bytes, (Bytes{255, 0, 0, 0, 255, 0, 0, 0, 255, 10, 20, 30})) << "alpha says nothing in MTL";
    EXPECT_EQ(s.textures[0].wrap_u, Wrap::repeat);
    EXPECT_EQ(s.meshes.at(0).uvs, (std::vector<glm::vec2>{{0, 1}, {1, 1}, {0, 0}})) << "v from the top";
    EXPECT_EQ(warned("texture"), 0u);
}

TEST_F(MtlMap, OptionsTurnRoundWithTheCoordinates) {
    for (const std::string options : {"-s 2 3 1 -o 0.25 0.5 0 -clamp on", "-clamp on -o 0.25 0.5 -s 2 3",
                                      "-blendu off -s 2 3 -texres 256 -o 0.25 0.5 -mm 0 1 -clamp on"}) {
        const Scene s = scene("Kd 1 1 1\nmap_Kd " + options + " rgba.png");
        ASSERT_EQ(s.textures.size(), 1u) << options;
        const TextureUse use = s.materials.at(0).albedo_map;
        EXPECT_EQ(s.textures[0].wrap_u, Wrap::clamp);
        EXPECT_EQ(s.textures[0].wrap_v, Wrap::clamp);
        // In MTL's own terms: uv' = uv * s + o with v from the bottom.
        for (const glm::vec2 uv : {glm::vec2(0, 0), glm::vec2(0.3f, 0.8f)}) {
            const glm::vec2 expected = uv * glm::vec2(2, 3) + glm::vec2(0.25f, 0.5f);
            const glm::vec2 ours = glm::vec2(uv.x, 1 - uv.y) * use.scale + use.offset;
            EXPECT_NEAR(ours.x, expected.x, 1e-6);
            EXPECT_NEAR(1 - ours.y, expected.y, 1e-6);
        }
    }
    grey("a b.png", 1, {7});
    EXPECT_EQ(scene("map_Kd -s 2 a b.png  ").textures.at(0).bytes, Bytes{7}) << "names may hold blanks";
}

TEST_F(MtlMap, EmissionWithoutAFactorIsTheTexture) {
    EXPECT_EQ(scene("map_Ke rgba.png").materials.at(0).emission, glm::vec3(1.f));
    EXPECT_EQ(scene("Ke 5 4 3\nmap_Ke rgba.png").materials.at(0).emission, glm::vec3(5, 4, 3));
}

TEST_F(MtlMap, RoughnessAndMetallicArePacked) {
    grey("rough.png", 2, {10, 20});
    grey("metal.png", 1, {200, 100});
    Scene s = scene("Kd 1 1 1\nmap_Pr rough.png\nmap_Pm metal.png");
    const Material& m = s.materials.at(0);
    EXPECT_EQ(m.kind, MaterialKind::principled);
    EXPECT_EQ(m.roughness, 1.f);
    EXPECT_EQ(m.metallic, 1.f);
    const Texture& t = s.textures.at(m.metallic_roughness_map.texture);
    EXPECT_EQ(t.format, TexelFormat::linear8);
    EXPECT_EQ(t.bytes, (Bytes{0, 10, 200, 0, 20, 200, 0, 10, 100, 0, 20, 100})) << "stretched over each other";
    s = scene("Kd 1 1 1\nPm 0.5\nmap_Pr rough.png");
    EXPECT_EQ(s.materials.at(0).metallic, 0.5f);
    EXPECT_EQ(s.textures.at(0).bytes, (Bytes{0, 10, 255, 0, 20, 255})) << "what has no map is multiplied by 1";
}

TEST_F(MtlMap, OpacityIsACutOutOrBlends) {
    grey("leaf.png", 4, {0, 255, 255, 0});
    grey("veil.png", 4, {0, 100, 150, 255});
    Scene s = scene("Kd 1 1 1\nmap_d leaf.png");
    EXPECT_EQ(s.materials.at(0).alpha_mode, AlphaMode::mask);
    EXPECT_EQ(s.textures.at(s.materials[0].opacity_map.texture).channels, 1u);
    EXPECT_EQ(scene("Kd 1 1 1\nmap_d veil.png").materials.at(0).alpha_mode, AlphaMode::blend);
    s = scene("Kd 1 1 1\nmap_d rgba.png\nmap_Kd rgba.png");
    EXPECT_EQ(s.textures.at(s.materials.at(0).opacity_map.texture).bytes, (Bytes{255, 128, 0, 40})) << "by its alpha";
    grey("color.png", 1, {255, 0, 0, 255, 0, 255, 0, 255}, 4);
    s = scene("Kd 1 1 1\nmap_d color.png");
    EXPECT_EQ(s.textures.at(0).bytes, (Bytes{54, 182})) << "luminance where the alpha says nothing";
    s = scene("Kd 1 1 1\nmap_d -imfchan g color.png");
    EXPECT_EQ(s.textures.at(0).bytes, (Bytes{0, 255}));
}

TEST_F(MtlMap, Relief) {
    grey("height.png", 4, {0, 255, 255, 0});
    grey("normals.png", 1, {127, 128, 255, 140, 110, 250}, 3);
    Scene s = scene("Kd 1 1 1\nnorm -bm 0.5 normals.png\nbump height.png");
    EXPECT_EQ(s.materials.at(0).normal_scale, 0.5f);
    EXPECT_TRUE(s.materials[0].normal_map.used());
    EXPECT_FALSE(s.materials[0].height_map.used()) << "one is enough";
    EXPECT_EQ(s.textures.at(0).format, TexelFormat::linear8);
    for (const char* key : {"bump", "map_bump", "map_Bump"}) {
        // A unit of texture coordinates is a unit of the scene: a texel of four is a quarter of that.
        s = scene("Kd 1 1 1\n" + std::string(key) + " -bm 3 height.png");
        EXPECT_TRUE(s.materials.at(0).height_map.used());
        EXPECT_FLOAT_EQ(s.materials[0].height_scale, 0.75f);
    }
    s = scene("Kd 1 1 1\nbump -s 2 2 -bm 3 height.png");
    EXPECT_FLOAT_EQ(s.materials.at(0).height_scale, 0.375f);
    s = scene("Kd 1 1 1\ndisp -mm 0 2 height.png");
    EXPECT_EQ(s.materials.at(0).height_scale, 2.f) << "in units of the scene";
    s = scene("Kd 1 1 1\nbump -bm 2 normals.png");
    EXPECT_TRUE(s.materials.at(0).normal_map.used());
    EXPECT_EQ(s.materials[0].normal_scale, 2.f);
    EXPECT_EQ(warned("contains normals"), 1u);
}

TEST_F(MtlMap, SpecularColorsMirrorsOnly) {
    const Scene s = scene("Kd 0 0 0\nKs 1 1 1\nNs 30\nmap_Ks pal.png");
    EXPECT_EQ(s.materials.at(0).kind, MaterialKind::metal);
    EXPECT_EQ(s.textures.at(s.materials[0].albedo_map.texture).bytes, (Bytes{200, 100, 50, 9, 8, 7}));
    EXPECT_TRUE(scene("Kd 1 1 1\nKs 1 1 1\nillum 1\nmap_Ks pal.png\nmap_Ns pal.png").textures.empty());
    EXPECT_EQ(warned("map_Ks is ignored"), 1u);
    EXPECT_EQ(warned("map_Ns is ignored"), 1u);
}

TEST_F(MtlMap, HighlightHasColorAndExponent) {
    const Scene s = scene("Kd 1 1 1\nNs 30\nillum 2\nmap_Ks pal.png\nmap_Ns pal.png");
    const Material& m = s.materials.at(0);
    EXPECT_EQ(m.kind, MaterialKind::blinn_phong);
    EXPECT_EQ(m.specular, glm::vec3(1.f)) << "times 1 where there is no Ks";
    EXPECT_EQ(s.textures.at(m.specular_map.texture).bytes, (Bytes{200, 100, 50, 9, 8, 7}));
    EXPECT_EQ(s.textures.at(m.specular_map.texture).format, TexelFormat::srgb8);
    EXPECT_EQ(s.textures.at(m.shininess_map.texture).channels, 1u);
    EXPECT_EQ(warned("map_"), 0u);
}

TEST_F(MtlMap, ImagesAreSharedAndUnusedOnesNotRead) {
    const Scene s = Mtl::load(
        "newmtl a\nKd 1 1 1\nmap_Kd rgba.png\nnewmtl b\nKd 1 0 0\nmap_Kd rgba.png\n"
        "newmtl unused\nmap_Kd gone.png\n",
        "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    EXPECT_EQ(s.textures.size(), 1u);
    EXPECT_EQ(s.materials.at(1).albedo_map.texture, 0u);
}

TEST_F(MtlMap, BadImages) {
    static_cast<void>(folder.file("cut.png", from_base64(test::png_rgba).substr(0, 60)));
    for (const char* key : {"map_Kd", "map_Ke", "map_d", "map_Pr", "map_Pm", "norm", "bump", "disp"})
        refuse(std::string("Kd 1 1 1\n") + key + " cut.png", {"cut.png", "cut off"});
}

TEST_F(MtlMap, MissingImagesAreGrey) {
    const std::pair<const char*, const char*> names[] = {{"gone.png", "mesh.obj': the image 'gone.png' is missing"},
                                                         {"../up.png", "leaves the scene's folder"},
                                                         {"..\\up.png", "leaves the scene's folder"},
                                                         {"/etc/passwd", "absolute"},
                                                         {"C:\\a.png", "drive"}};
    for (const auto& [name, why] : names) {
        warnings.clear();
        const Scene missing = scene("Kd 1 1 1\nillum 1\nmap_Kd " + std::string(name));
        EXPECT_EQ(missing.materials.at(0).albedo, glm::vec3(0.5f)) << name;
        EXPECT_TRUE(missing.textures.empty()) << name;
        EXPECT_EQ(warned(why), 1u) << name;
    }
    warnings.clear();
    const Material m = scene("Kd 1 1 1\nKe 1 1 1\nmap_Ke no.png\nmap_d no.png\nnorm no.png\nbump no.png\nmap_Ks no.png")
                           .materials.at(0);
    EXPECT_EQ(m.emission, glm::vec3(0.f));
    EXPECT_EQ(m.alpha_mode, AlphaMode::opaque);
    EXPECT_FALSE(m.normal_map.used() || m.height_map.used() || m.specular_map.used());
    EXPECT_EQ(warned("no.png"), 1u) << "one warning is enough";
}

TEST_F(MtlMap, NamesAreRelativeToTheMtl) {
    std::filesystem::create_directory(folder / "sub");
    static_cast<void>(folder.file("sub/x.mtl", "newmtl a\nmap_Kd in.png\nnewmtl b\nmap_Kd ../rgba.png\n"));
    static_cast<void>(folder.file("sub/in.png", from_base64(test::png_palette)));
    const Scene s = load_obj(
        folder.file("mesh.obj", "mtllib sub/x.mtl\n" + one_face + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"), warnings);
    EXPECT_EQ(s.textures.size(), 2u);
}

/// Whatever happens to the bytes, the result is a sound scene or one line.
TEST_F(MtlMap, BrokenFilesNeverCrash) {
    grey("g.png", 2, {1, 2});
    const std::string mtl =
        "newmtl a\nKd 0.5 0.5 0.5\nPr 0.5\nmap_Kd -s 2 2 -o 0.5 g.png\nmap_Pr g.png\nbump -bm 2 g.png\n"
        "map_d g.png\nillum 2\nd 0.9\nTf 1 1 1\n";
    const std::string obj =
        "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0.5\nvn 0 0 1\nusemtl a\n"
        "f 1/1/1 2/2/1 3/1/1\nf -1//1 -2//1 -3//1\n";
    std::minstd_rand random(3);
    for (int trial = 0; trial < 2000; ++trial) {
        std::string text[2] = {mtl, obj};
        std::string& broken = text[trial % 2];
        if (trial < 400) broken.resize(random() % broken.size());
        for (unsigned flips = random() % 4; flips > 0 && !broken.empty(); --flips)
            broken[random() % broken.size()] = char(32 + random() % 96);
        static_cast<void>(folder.file("m.mtl", text[0]));
        try {
            validate(load_obj(folder.file("mesh.obj", text[1]), warnings));
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace claray
