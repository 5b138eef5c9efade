// MTL as other programs write it: spelling, options, statements that claray does not know.
#include <gtest/gtest.h>

#include "tests/io/expect_error.hpp"

namespace claray {
namespace {

class MtlText : public test::ReaderTest {
protected:
    MtlText() {
        Texture image;
        image.width = image.height = 1, image.channels = 3, image.bytes = {10, 20, 30};
        for (const char* name : {"a.png", "a b.png", "a -s x.png", "-a.png"}) write_texture(folder / name, image);
    }
    Scene load(const std::string& description) {
        warnings.clear();
        static_cast<void>(folder.file("m.mtl", "newmtl a\n" + description + "\n"));
        return load_obj(
            folder.file("mesh.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n"),
            warnings);
    }
    TextureUse use(const std::string& description) { return load(description).materials.at(0).albedo_map; }
};

TEST_F(MtlText, OptionsMayStandBehindTheName) {
    for (const char* line :
         {"map_Kd -s 2 3 1 -o 0.5 a.png", "map_Kd a.png -s 2 3 1 -o 0.5", "map_Kd -s 2 3 a.png -o 0.5 0",
          "map_Kd \"a b.png\" -S 2 3 -cc on -o 0.5 -clamp off", "map_Kd -cc on -s 2 3 1 -o 0.5 a b.png",
          "map_Kd -texres 512 -blendu on -s 2 3 -o 0.5 \"a.png\""}) {
        const TextureUse found = use(line);
        EXPECT_TRUE(found.used()) << line;
        EXPECT_EQ(found.scale, glm::vec2(2, 3)) << line;
        EXPECT_EQ(found.offset.x, 0.5f) << line;
        EXPECT_EQ(warned("png"), 0u) << line;
    }
    for (const char* line :
         {"map_Kd a -s x.png", "map_Kd -cc on -a.png", "map_Kd -clamp a.png", "map_Kd a.png -cc on"}) {
        EXPECT_EQ(use(line).scale, glm::vec2(1)) << line;
        EXPECT_EQ(warned("png"), 0u) << line;
    }
}

TEST_F(MtlText, KeywordsInAnyCase) {
    const Material m = load("KD 1 0.5 0\nMAP_KD a.png\nNEWMTL b\nkd 0 0 1").materials.at(0);
    EXPECT_EQ(m.albedo, glm::vec3(1, 0.5f, 0));
    EXPECT_TRUE(m.albedo_map.used());
    for (const char* line : {"Map_Bump a.png", "map_BUMP a.png", "BUMP a.png", "Norm a.png", "map_Norm a.png"}) {
        const Material relief = load(line).materials.at(0);
        EXPECT_TRUE(relief.height_map.used() || relief.normal_map.used()) << line;
    }
    EXPECT_EQ(warned("is not an MTL statement"), 0u);
}

TEST_F(MtlText, AnImageWithoutColourIsNotDarkened) {
    EXPECT_EQ(load("illum 1\nmap_Kd a.png").materials.at(0).albedo, glm::vec3(1));
    EXPECT_EQ(load("map_Kd a.png\nKd 0.5 0.5 0.5").materials.at(0).albedo, glm::vec3(0.5f));
}

TEST_F(MtlText, AHaloIsAnOpacity) {
    const Material m = load("Kd 1 0 0\nillum 1\nd -halo 0.75").materials.at(0);
    EXPECT_EQ(m.kind, MaterialKind::lambert);
    EXPECT_EQ(m.opacity, 0.75f);
    EXPECT_EQ(warned("m.mtl line 4: '-halo' is ignored"), 1u);
}

TEST_F(MtlText, WhatIsIgnoredIsSaid) {
    load(
        "Kd 1 1 1\nfoo 1\nfoo 2\nbar\nPs 0.5\naniso 0.0\nanisor 0\nrefl -type sphere a.png\nKa 1 1 1\nsharpness 60\n"
        "d 1\nTr 0.5");
    EXPECT_EQ(warned("m.mtl line 3 (and 1 more): 'foo' is not an MTL statement: the line is ignored"), 1u);
    EXPECT_EQ(warned("m.mtl line 5: 'bar' is not an MTL statement"), 1u);
    EXPECT_EQ(warned("m.mtl line 6: 'Ps' is not supported: it is ignored"), 1u);
    EXPECT_EQ(warned("'refl' is not supported"), 1u);
    EXPECT_EQ(warned("has both d and Tr: Tr is ignored"), 1u);
    for (const char* silent : {"aniso", "Ka", "sharpness"}) EXPECT_EQ(warned(silent), 0u) << silent;
}

}  // namespace
}  // namespace claray
