// MTL: which of claray's materials a description becomes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "claray/io.hpp"
#include "tests/io/temporary_folder.hpp"

namespace claray {
namespace {

using test::TemporaryFolder;

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class Mtl : public ::testing::Test {
protected:
    Scene load(const std::string& mtl, const std::string& faces) {
        static_cast<void>(folder.file("m.mtl", mtl));
        Scene scene = load_obj(folder.file("mesh.obj", "mtllib m.mtl\n" + triangle + faces), warnings);
        validate(scene);
        return scene;
    }
    Material load(const std::string& description) {
        return load("newmtl a\n" + description + "\n", "usemtl a\nf 1 2 3\n").materials.at(0);
    }
    [[nodiscard]] std::size_t warned(const std::string& word) const {
        return std::size_t(std::count_if(warnings.begin(), warnings.end(), [&](const std::string& line) {
            return line.find(word) != std::string::npos;
        }));
    }

    TemporaryFolder folder;
    Warnings warnings;
};

TEST_F(Mtl, DiffuseIsLambert) {
    const Material m = load("Kd 0.1 0.2 0.3\nKs 0.5 0.5 0.5\nNs 96\nillum 2");
    EXPECT_EQ(m.kind, MaterialKind::lambert);
    EXPECT_EQ(m.name, "a");
    EXPECT_EQ(m.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.emission, glm::vec3(0.f));
    EXPECT_EQ(warned("a"), warned("no material emits light")) << warnings.at(0);
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
    EXPECT_EQ(load("Kd 1 0.7 0.3\nPm 0.2\nPr 0.4").kind, MaterialKind::lambert);
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
        load_obj(folder.file("mesh.obj", "mtllib gone.mtl\n" + triangle + "usemtl a\nf 1 2 3\n"), warnings);
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
        load_obj(folder.file("mesh.obj", "mtllib a.mtl b.mtl gone.mtl\nmtllib of mine.mtl\n" + triangle +
                                             "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n"),
                 warnings);
    ASSERT_EQ(scene.materials.size(), 3u);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.materials[std::size_t(i)].albedo[i], 1.f);
    EXPECT_EQ(warned("is missing"), 1u);
}

TEST_F(Mtl, TexturesAreReported) {
    load("newmtl a\nmap_Kd wood.png\n", "usemtl a\nf 1 2 3\n");
    EXPECT_EQ(warned("1 materials name textures"), 1u);
}

}  // namespace
}  // namespace claray
