// OBJ and MTL as other programs write them: encodings, line ends, names of files; and what a file asks for in vain.
#include <gtest/gtest.h>

#include <algorithm>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
namespace fs = std::filesystem;

const std::string plain_triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string red = "newmtl red\nKd 1 0 0\n";

class ObjText : public test::ReaderTest {
protected:
    Scene load(const std::string& text) {
        fs::create_directories(folder / "scene");
        warnings.clear();
        Scene scene = load_obj(folder.file("scene/mesh.obj", text), warnings);
        validate(scene);
        return scene;
    }
    void mtl(const std::string& name, const std::string& text) {
        fs::create_directories((folder / "scene" / name).parent_path());
        static_cast<void>(folder.file("scene/" + name, text));
    }
    /// Nothing but of the light.
    [[nodiscard]] bool silent() const {
        return std::all_of(warnings.begin(), warnings.end(),
                           [](const std::string& line) { return line.find("neutral studio") != std::string::npos; });
    }
    /// The triangle is there and red.
    void expect_red(const std::string& text) {
        const Scene scene = load(text);
        ASSERT_EQ(triangle_count(scene), 1u) << text;
        EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 0, 0)) << text;
        EXPECT_EQ(scene.materials.at(scene.meshes[0].materials.at(0)).albedo, glm::vec3(1, 0, 0)) << text;
    }
    static std::string replaced(std::string text, const std::string& from, const std::string& to) {
        for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
            text.replace(at, from.size(), to);
        return text;
    }
};

TEST_F(ObjText, ByteOrderMarksAndLineEnds) {
    const std::string mark = "\xef\xbb\xbf", obj = "mtllib m.mtl\n" + plain_triangle + "usemtl red\nf 1 2 3";
    mtl("m.mtl", mark + red);
    expect_red(mark + obj);
    EXPECT_EQ(load(mark + plain_triangle + "f 1 2 3\n").meshes[0].positions.size(), 3u) << "the first vertex";
    for (const char* end : {"\r", "\r\n"}) {
        mtl("m.mtl", replaced(red + "\nnewmtl other", "\n", end));
        expect_red(replaced(obj, "\n", end));
        EXPECT_TRUE(silent()) << warnings.front();
    }
    mtl("m.mtl", replaced(red, " ", "\t"));
    expect_red(replaced(obj, " ", "\t"));
    mtl("m.mtl", "newmtl \\\nred\nKd 1 \\\n 0 \\\n0");
    expect_red(replaced(obj, "f 1 2 3", "f 1 \\\n 2 \\\r\n3"));
    EXPECT_TRUE(silent()) << warnings.front();
}

TEST_F(ObjText, ABackslashContinuesNoComment) {
    mtl("m.mtl", "# from C:\\models\\\n" + red);
    expect_red("# from C:\\models\\\nmtllib m.mtl\n# to D:\\\n" + plain_triangle + "usemtl red\nf 1 2 3\n");
}

TEST_F(ObjText, LinesKeepTheirNumbers) {
    mtl("m.mtl", "newmtl red\nKd 1 \\\n\\\n 0 0\nKs x 1 1\n");
    static_cast<void>(load("mtllib m.mtl\n" + plain_triangle + "usemtl red\nf 1 2 3\n"));
    EXPECT_TRUE(warned("m.mtl line 5: 'x'")) << warnings.front();
}

TEST_F(ObjText, NamesOfMaterialFiles) {
    for (const char* name : {"a b.mtl", "two  blanks.mtl", "sub/m.mtl", "m.mtl"}) mtl(name, red);
    mtl("plain.mtl", "newmtl blue\nKd 0 0 1\n");
    for (const char* line : {"a b.mtl", "\"a b.mtl\"", "two  blanks.mtl", "./m.mtl", ".\\sub\\m.mtl", "sub/m.mtl",
                             "plain.mtl m.mtl", "plain.mtl a b.mtl", "a b.mtl plain.mtl", "a\\ b.mtl plain.mtl",
                             "  m.mtl  ", "C:\\work\\of others\\m.mtl", "/home/me/m.mtl", "\\\\server\\share\\m.mtl"})
        expect_red(std::string("mtllib ") + line + "\n" + plain_triangle + "usemtl red\nf 1 2 3\n");
    EXPECT_TRUE(warned("mesh.obj': '\\\\server\\share\\m.mtl' is a path on another machine")) << warnings.front();
    static_cast<void>(load("mtllib C:\\work\\gone.mtl m.mtl\n" + plain_triangle + "usemtl red\nf 1 2 3\n"));
    EXPECT_TRUE(warned("gone.mtl' is missing")) << warnings.front();
}

/// A file that names so many has no blanks in its names: all ways to join them would be looked for.
TEST_F(ObjText, ManyMaterialFilesOnALineHaveNoBlanks) {
    mtl("a b.mtl", red), mtl("last.mtl", red);
    std::string many = "mtllib a b.mtl";
    for (int i = 0; i < 64; ++i) many += " m" + std::to_string(i) + ".mtl";
    expect_red(many + " last.mtl\n" + plain_triangle + "usemtl red\nf 1 2 3\n");
    EXPECT_TRUE(warned("/a' is missing"));
}

/// Of a million lines each is read once.
TEST_F(ObjText, LinesThatGoOnWithoutEnd) {
    std::string lines;
    for (int i = 0; i < 1'000'000; ++i) lines += "\\\n";
    EXPECT_EQ(triangle_count(load(lines + plain_triangle + "f 1 2 3\n")), 1u);
}

TEST_F(ObjText, LinesAndPointsAreDrawn) {
    mtl("m.mtl", red);
    const Scene scene = load("mtllib m.mtl\nusemtl red\n" + plain_triangle + "l 1/1 2 -1\np 1 2\nf 1 2 3\nvt 0 0\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.primitives.size(), 2u);
    EXPECT_EQ(scene.primitives[0].kind, PrimitiveSet::Kind::spheres);
    EXPECT_EQ(scene.primitives[0].points.size(), 3u) << "places that lines and points share have one ball";
    EXPECT_EQ(scene.primitives[1].kind, PrimitiveSet::Kind::cylinders);
    ASSERT_EQ(scene.primitives[1].points.size(), 4u);
    EXPECT_EQ(glm::vec3(scene.primitives[1].points[3]), glm::vec3(scene.primitives[0].points[2]));
    EXPECT_EQ(scene.materials.at(scene.primitives[1].materials.at(0)).name, "red");
    EXPECT_TRUE(warned("points or lines are shown as spheres and tubes"));
    const Scene alone = load("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1e39 0 0\nl 1 2\np 3\n");
    ASSERT_EQ(alone.primitives.size(), 2u) << "without faces, and without what is not finite";
    EXPECT_EQ(alone.primitives[1].colors.at(1), glm::vec3(0, 1, 0));
    const auto path = folder.file("lines.obj", plain_triangle + "l 1 2\n");
    EXPECT_EQ(load_scene(path.string(), warnings, {.stroke_radius = 0.25f}).primitives.at(0).points.at(0).w, 0.25f);
    for (const char* bad : {"l 1 4\n", "p 0\n", "l 1 x\n"})
        expect_error(ErrorKind::user, {"mesh.obj' line "}, [&] { static_cast<void>(load(plain_triangle + bad)); });
}

TEST_F(ObjText, MaterialFilesStayInTheScenesFolder) {
    static_cast<void>(folder.file("secret.mtl", "newmtl secret\n"));
    fs::create_directories(folder / "scene");
    fs::create_symlink("../secret.mtl", folder / "scene/link.mtl");
    const std::pair<std::string, const char*> cases[] = {
        {"/etc/passwd", "is absolute"},
        {"../secret.mtl", "leaves the scene's folder"},
        {"..\\secret.mtl", "leaves the scene's folder"},
        {"link.mtl", "leaves the scene's folder"},
        {(folder / "secret.mtl").string(), "is absolute"},
    };
    for (const auto& [name, why] : cases)
        expect_error(ErrorKind::user, {"mesh.obj'", why}, [&, n = name] {
            static_cast<void>(load("mtllib " + n + "\n" + plain_triangle + "usemtl secret\nf 1 2 3\n"));
        });
}

TEST_F(ObjText, ImagesOfOtherMachinesAreFoundBesideTheFile) {
    mtl("m.mtl", red + "map_Kd C:\\textures\\wood.pfm\n");
    mtl("wood.pfm", std::string("PF\n1 1\n-1\n") + std::string(12, '\0'));
    const std::string obj = "mtllib m.mtl\n" + plain_triangle + "vt 0 0\nusemtl red\nf 1/1 2/1 3/1\n";
    EXPECT_EQ(load(obj).textures.size(), 1u);
    EXPECT_TRUE(warned("'C:\\textures\\wood.pfm' is a path on another machine")) << warnings.front();
    fs::remove(folder / "scene/wood.pfm");
    EXPECT_EQ(load(obj).textures.size(), 0u);
    EXPECT_TRUE(warned("wood.pfm' is a URL or contains a drive")) << warnings.front();
    mtl("m.mtl", red + "map_Kd maps/wood.pfm\n");
    mtl("wood.pfm", std::string("PF\n1 1\n-1\n") + std::string(12, '\0'));
    EXPECT_EQ(load("mtllib sub/m.mtl\n" + obj.substr(obj.find('\n') + 1)).textures.size(), 1u);
    EXPECT_TRUE(warned("mesh.obj': 'sub/m.mtl' is missing: '")) << warnings.front();
    EXPECT_TRUE(warned("mesh.obj': 'maps/wood.pfm' is missing: '")) << warnings.front();
}

TEST_F(ObjText, OtherEncodingsAreNamed) {
    std::string little, big;
    for (const char c : plain_triangle) little += {c, '\0'}, big += {'\0', c};
    const auto refuse = [&](const std::string& bytes, const char* what) {
        expect_error(ErrorKind::user, {"mesh.obj' is", what}, [&] { static_cast<void>(load(bytes)); });
        mtl("m.mtl", bytes);
        expect_error(ErrorKind::user, {"m.mtl' is", what},
                     [&] { static_cast<void>(load("mtllib m.mtl\n" + plain_triangle + "f 1 2 3\n")); });
        expect_error(ErrorKind::user, {"s.gltf' is", what}, [&] {
            Warnings ignored;
            static_cast<void>(load_gltf(folder.file("s.gltf", bytes), ignored));
        });
    };
    refuse("\xff\xfe" + little, "UTF-16");
    refuse("\xfe\xff" + big, "UTF-16");
    refuse(little, "UTF-16");
    refuse(big, "UTF-16");
    refuse("\x1f\x8b\x08 and so on", "gzip");
    refuse("PK\x03\x04 and so on", "zip archive");
}

TEST_F(ObjText, WhatIsAskedForInVainIsSaid) {
    EXPECT_EQ(load(plain_triangle + "usemtl red\nf 1 2 3\n").materials.size(), 1u);
    EXPECT_TRUE(warned("mesh.obj' uses materials, 'red' for example, but has no mtllib line"));
    mtl("empty.mtl", "\n");
    static_cast<void>(load("mtllib empty.mtl\n" + plain_triangle + "usemtl red\nf 1 2 3\n"));
    EXPECT_TRUE(warned("material 'red' is not defined"));
    static_cast<void>(load(plain_triangle + "f 1 2 3\ncstype bezier\nfoo 1 2\nfoo\n"));
    EXPECT_TRUE(warned("line 5: 'cstype' is ignored"));
    EXPECT_TRUE(warned("line 6 (and 1 more): 'foo' is not an OBJ statement"));
    static_cast<void>(load(plain_triangle + "s 1\nf 1 2 3\n"));
    EXPECT_TRUE(warned("line 4: 's' (a smoothing group) is ignored"));
    static_cast<void>(load(plain_triangle + "vn 0 0 1\ns 1\nf 1//1 2//1 3//1\n"));
    EXPECT_TRUE(silent());
    static_cast<void>(load(plain_triangle + "o a\ng b\ns off\nf 1 2 3\n"));
    EXPECT_TRUE(silent());
}

TEST_F(ObjText, AttributesOfWhichThereAreNoneAreLeftOut) {
    for (const char* face : {"f 1/1/1 2/2/2 3/3/3\n", "f -3/-3/-3 -2/-2/-2 -1/-1/-1\n"}) {
        const Scene scene = load(plain_triangle + face);
        EXPECT_EQ(triangle_count(scene), 1u);
        EXPECT_TRUE(scene.meshes[0].normals.empty() && scene.meshes[0].uvs.empty());
        EXPECT_TRUE(warned("mesh.obj': faces refer to texture coordinates, but there are none"));
        EXPECT_TRUE(warned("mesh.obj': faces refer to normals, but there are none"));
    }
    // Where there are some, an index beyond them is an error as before.
    for (const char* face : {"vt 0 0\nf 1/1 2/2 3/1\n", "f 1/-1 2/-1 3/-1\nvt 0 0\n"})
        expect_error(ErrorKind::user, {"texture index", "out of range"},
                     [&] { static_cast<void>(load(plain_triangle + face)); });
}

}  // namespace
}  // namespace claray
