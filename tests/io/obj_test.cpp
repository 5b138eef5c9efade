// OBJ: geometry, groups, and every way in which a file can be bad.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "claray/io.hpp"
#include "host/base/format.hpp"
#include "host/io/obj/obj_corner.hpp"
#include "host/io/words.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;

class Obj : public test::ReaderTest {
protected:
    Scene load(const std::string& text) {
        warnings.clear();
        Scene scene = load_obj(folder.file("mesh.obj", text), warnings);
        validate(scene);
        return scene;
    }
};

// Sum of the triangles' area vectors: the polygon's own, however it was cut, if none overlaps or is turned over.
glm::vec3 area_vector(const Mesh& mesh) {
    glm::vec3 sum(0.f);
    for (const glm::uvec3& t : mesh.triangles)
        sum += 0.5f * glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    return sum;
}
float area(const Mesh& mesh) {
    float sum = 0.f;
    for (const glm::uvec3& t : mesh.triangles)
        sum += 0.5f * glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                             mesh.positions[t.z] - mesh.positions[t.x]));
    return sum;
}

const std::string unit_square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(Obj, TriangleIsReadAsItStands) {
    const Scene scene = load("v 0 0 0\nv 1.5 0 0\nv 0 -2e-1 3\nf 1 2 3\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.name, "mesh");
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(mesh.positions[1], glm::vec3(1.5f, 0.f, 0.f));
    EXPECT_EQ(mesh.positions[2], glm::vec3(0.f, -0.2f, 3.f));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.uvs.empty());
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].kind, MaterialKind::lambert);
}

TEST_F(Obj, QuadBecomesTwoTrianglesThatShareVertices) {
    const Mesh mesh = load(unit_square + "f 1 2 3 4\n").meshes.at(0);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(area_vector(mesh), glm::vec3(0.f, 0.f, 1.f));
    EXPECT_FLOAT_EQ(area(mesh), 1.f);
}

TEST_F(Obj, ConcaveQuadIsNotCutAcross) {
    // An arrowhead: its shorter diagonal lies outside.
    const Mesh mesh = load("v 0 0 0\nv 4 2 0\nv 0 4 0\nv 3 2 0\nf 1 2 3 4\n").meshes.at(0);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_FLOAT_EQ(area_vector(mesh).z, 2.f);
    EXPECT_FLOAT_EQ(area(mesh), 2.f);
}

TEST_F(Obj, ConcavePolygonsKeepTheirAreaInEveryPlane) {
    // A comb with five teeth, in three planes, far from the origin, both ways round.
    const int teeth = 5;
    std::vector<glm::dvec2> comb = {{0, 0}, {2 * teeth - 1, 0}};
    for (int i = teeth; i-- > 0;) {
        comb.insert(comb.end(), {{2 * i + 1, 4}, {2 * i, 4}});
        if (i) comb.insert(comb.end(), {{2 * i, 1}, {2 * i - 1, 1}});
    }
    const float expected = (2 * teeth - 1) * 1.f + teeth * 3.f;
    for (int plane = 0; plane < 3; ++plane) {
        for (const bool reversed : {false, true}) {
            std::string text, face = "f";
            for (std::size_t i = 0; i < comb.size(); ++i) {
                double p[3] = {1000, 1000, 1000};
                p[(plane + 1) % 3] += comb[i].x;
                p[(plane + 2) % 3] += comb[i].y;
                text += "v " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
                face += " " + std::to_string(reversed ? comb.size() - i : i + 1);
            }
            const Mesh mesh = load(text + face + "\n").meshes.at(0);
            EXPECT_EQ(mesh.triangles.size(), comb.size() - 2);
            EXPECT_FLOAT_EQ(area(mesh), expected);
            EXPECT_FLOAT_EQ(area_vector(mesh)[plane], reversed ? -expected : expected);
        }
    }
}

TEST_F(Obj, PolygonsThatCrossThemselvesOrHoldNanAreCutAnyway) {
    EXPECT_EQ(load("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n").meshes[0].triangles.size(), 2u);
    EXPECT_EQ(load("v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3 4 5\n").meshes[0].triangles.size(), 3u);
    EXPECT_EQ(load("v 0 0 0\nv 1 nan 0\nv 1 1 0\nv 0 1 0\nv 0 .5 0\nf 1 2 3 4 5\n").meshes[0].triangles.size(), 3u);
}

TEST_F(Obj, NegativeIndicesCountBackFromWhereTheyStand) {
    const Mesh mesh = load("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nf -4 -3 -1\n").meshes.at(0);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions[mesh.triangles[0].x], glm::vec3(0.f));
    EXPECT_EQ(mesh.positions[mesh.triangles[0].z], glm::vec3(0.f, 1.f, 0.f));
    EXPECT_EQ(mesh.positions[mesh.triangles[1].x], glm::vec3(0.f));
    EXPECT_EQ(mesh.positions[mesh.triangles[1].z], glm::vec3(5.f, 0.f, 0.f));
}

TEST_F(Obj, AFaceMayNameLaterVertices) {
    const Mesh mesh = load("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").meshes.at(0);
    EXPECT_FLOAT_EQ(area_vector(mesh).z, 0.5f);
}

TEST_F(Obj, VerticesAreSharedWherePositionNormalAndUvAgree) {
    const std::string attributes = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 2\nvn 0 1 0\n";
    const std::string first = "f 1/1/1 2/2/1 3/3/1\n";
    const Mesh shared = load(unit_square + attributes + first + "f 1/1/1 3/3/1 4/4/1\n").meshes.at(0);
    EXPECT_EQ(shared.positions.size(), 4u);
    EXPECT_EQ(shared.normals.at(0), glm::vec3(0.f, 0.f, 1.f));  // made unit
    EXPECT_EQ(shared.uvs.at(shared.triangles[1].z), glm::vec2(0.f, 0.f)) << "v is counted from the top";

    const Mesh other_normal = load(unit_square + attributes + first + "f 1/1/2 3/3/2 4/4/2\n").meshes.at(0);
    EXPECT_EQ(other_normal.positions.size(), 6u);
    const Mesh other_uv = load(unit_square + attributes + first + "f 1/2/1 3/3/1 4/4/1\n").meshes.at(0);
    EXPECT_EQ(other_uv.positions.size(), 5u);
}

TEST_F(Obj, ACornerWithoutUsableNormalTakesItsFaces) {
    const Mesh mesh = load(unit_square +
                           "v 0 0 1\nvn 1 0 0\nvn 0 0 0\nvn nan 0 0\n"
                           "f 1//1 2//1 3//1\nf 1 3 4\nf 1//2 3//3 4//2\nf 1 4 5\n")
                          .meshes.at(0);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    const glm::vec3 x(1.f, 0.f, 0.f), z(0.f, 0.f, 1.f), expected[] = {x, z, z, x};
    for (std::size_t face = 0; face < 4; ++face)
        for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.normals[mesh.triangles[face][k]], expected[face]) << face;
}

TEST_F(Obj, GroupsAndObjectsAreMeshes) {
    const Scene scene = load(unit_square +
                             "f 1 2 3\ng left\nf 1 2 3\ng right side\nf 1 3 4\ng left\nf 2 3 4\n"
                             "o box\nf 1 2 3\ng lid\nf 1 2 4\n");
    std::vector<std::pair<std::string, std::size_t>> found;
    for (const Mesh& mesh : scene.meshes) found.emplace_back(mesh.name, mesh.triangles.size());
    const std::vector<std::pair<std::string, std::size_t>> expected = {
        {"mesh", 1}, {"left", 2}, {"right side", 1}, {"box", 1}, {"box/lid", 1}};
    EXPECT_EQ(found, expected);
    EXPECT_EQ(scene.meshes[2].positions.size(), 3u) << "a mesh holds only the vertices that it uses";
}

TEST_F(Obj, LineEndsCommentsAndContinuationsAreUnderstood) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text = "# comment\nv 0 0 0\nv 1 0 0\n\n  v 1 1 0\nv 0 1 0\nf 1 2 \\\n 3 4";
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
            text.replace(at, 1, end);
        EXPECT_EQ(load(text).meshes.at(0).triangles.size(), 2u);
        expect_error(ErrorKind::user, {"line 3", "index 5"},
                     [&] { load("v 0 0 0" + end + "v nan 0 0" + end + "f 1 2 5" + end + "f 1 2 1"); });
        const Mesh mesh = load("v 0 0 0" + end + "v 1 0 nan" + end + "v inf 0 0" + end + "f 1 2 3").meshes.at(0);
        EXPECT_TRUE(std::isnan(mesh.positions[1].z));
        EXPECT_TRUE(std::isinf(mesh.positions[2].x));
    }
}

TEST_F(Obj, NotFiniteVerticesAreKept) {
    const Mesh mesh = load("v 0 0 0\nv nan 0 1\nv 1 -inf +INF\nv 1e39 2 NaN\nf 1 2 3\nf 1 3 4\n").meshes.at(0);
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_TRUE(std::isnan(mesh.positions[1].x));
    EXPECT_EQ(mesh.positions[1].z, 1.f);
    EXPECT_EQ(mesh.positions[2], glm::vec3(1.f, -INFINITY, INFINITY));
    EXPECT_TRUE(std::isinf(mesh.positions[3].x));
    EXPECT_EQ(mesh.positions[3].y, 2.f);
    EXPECT_TRUE(std::isnan(mesh.positions[3].z));
    const Mesh old = load("v 0 0 0\nv 1.#INF -1.#inf 1.#IND\nv 1 0 0\nf 1 2 3\n").meshes.at(0);
    EXPECT_EQ(old.positions[1].x, INFINITY);
    EXPECT_EQ(old.positions[1].y, -INFINITY);
    EXPECT_TRUE(std::isnan(old.positions[1].z));
}

TEST_F(Obj, WhatIsNotFiniteIsCountedByKindWithItsFirstLine) {
    load(unit_square + "v 0 0 -nan(ind)\nv 1.#QNAN 0 0\nv 0 0 1e99\nvt inf\nvn 0 0 nan\nf 1/1/1 2/1/1 3/1/1\n");
    EXPECT_TRUE(warned("mesh.obj' line 5 (and 2 more): a vertex is not finite"));
    EXPECT_TRUE(warned("mesh.obj' line 8: a texture coordinate is not finite"));
    EXPECT_TRUE(warned("mesh.obj' line 9: a normal is not finite"));
    load(unit_square + "vt 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n");
    EXPECT_FALSE(warned("not finite"));
}

TEST_F(Obj, WhatIsNoNumberIsAnErrorThatNamesTheLine) {
    const auto refuse = [&](const std::string& line, std::initializer_list<std::string> words) {
        SCOPED_TRACE(line);
        expect_error(ErrorKind::user, {"mesh.obj' line 5: "}, [&] { load(unit_square + line + "\nf 1 2 3\n"); });
        expect_error(ErrorKind::user, words, [&] { load(unit_square + line + "\nf 1 2 3\n"); });
    };
    refuse("v 0 0 x", {"'x' is not a number"});
    refuse("v 0,5 0 0", {"'0,5' is not a number"});
    refuse("v 0x1 0 0", {"'0x1'"});
    refuse("v 0 1e 0", {"'1e'"});
    refuse("v 0 0 1e0000000001", {"'1e0000000001'"});  // the parser's limit
    refuse("v 1 2", {"'v' with 2 of 3 numbers"});
    refuse("v ", {"'v' with 0 of 3 numbers"});
    for (const std::string none : {"v", "\tv", "v\r"}) refuse(none, {"'v' with 0 of 3 numbers"});
    refuse("vn", {"'vn' with 0 of 3 numbers"});
    refuse("vt", {"'vt' with 0 of 1 number;"});
    refuse("v 1 2 # 3", {"2 of 3"});
    refuse("vn 0 1", {"'vn' with 2 of 3 numbers"});
    refuse("vn 0 1 up", {"'up'"});
    refuse("vt ", {"'vt' with 0 of 1 number;"});
    refuse("vt 0 v", {"'v' is not a number"});
    refuse("v 0 0 \x1b[31mred", {"'?[31mred'"});
    refuse(std::string("v 0 0 ") + std::string(100, 'x'), {std::string(40, 'x') + "...'"});
    for (const std::string corner :
         {"x", "1.5", "1/x", "1//x", "1/1/x", "/1", "1/1/1/1", "2147483648", "1/4294967297", "1-"})
        refuse("f 1 2 " + corner, {"'" + corner + "' is not a corner of a face"});
}

/// By the curve of IEC 61966-2-1: 0.5 is 0.21404, and below 0.04045 it is a line.
TEST_F(Obj, ColoursOfVerticesAreSrgb) {
    const Scene scene = load(
        "v 0 0 0 1 0 0.5\nv 1 0 0\nv 1 1 0 +0.0404 1e0 1\nf 1 2 3\nv 5 0 0\nv 6 0 0 2\no plain\n"
        "v 7 1 0 1 1 1\nf 4 5 6\n");
    ASSERT_EQ(scene.meshes.size(), 2u);
    const std::vector<glm::vec4>& colors = scene.meshes[0].colors;
    ASSERT_EQ(colors.size(), 3u);
    EXPECT_EQ(colors[0].x, 1.f);
    EXPECT_EQ(colors[0].y, 0.f);
    EXPECT_NEAR(colors[0].z, 0.2140411, 1e-6);
    EXPECT_EQ(colors[1], glm::vec4(1.f)) << "a vertex without one is white";
    EXPECT_NEAR(colors[2].x, 0.0404 / 12.92, 1e-8);
    EXPECT_TRUE(scene.meshes[1].colors.empty()) << "a fourth number is a weight, and white is none";
    EXPECT_FALSE(warned("colour"));
}

TEST_F(Obj, ColoursBeyondOneAreClampedWithAWarning) {
    const Scene scene = load("v 0 0 0 255 0 0\nv 1 0 0 0 -1 0\nv 1 1 0 0 0 1\nf 1 2 3\n");
    EXPECT_EQ(scene.meshes.at(0).colors, (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 0, 0, 1}, {0, 0, 1, 1}}));
    EXPECT_TRUE(warned("line 1 (and 1 more): a vertex has a colour that is not three numbers in 0..1"));
    EXPECT_EQ(load("v 0 0 0 1 0 red\nv 1 0 0 1 0 0\nv 1 1 0 nan 0 0\nf 1 2 3\n").meshes.at(0).colors,
              (std::vector<glm::vec4>{{1, 1, 1, 1}, {1, 0, 0, 1}, {1, 1, 1, 1}}));
    EXPECT_TRUE(warned("line 1 (and 1 more)"));
}

TEST_F(Obj, WordsBehindTheLastNumberAreNoMatter) {
    const Mesh mesh =
        load("v 0 0 0 1 # w\nv 1 0 0 .5 .5 .5\nv 0 1 0 red\nvt 1\nvt .5 .5 x\nf 1/ 2/2/ 3/1 # comment 4\n")
            .meshes.at(0);
    EXPECT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.uvs, (std::vector<glm::vec2>{{0.f, 0.f}, {.5f, .5f}, {1.f, 1.f}}));
}

// The C library decides what is a number, and its value.
TEST_F(Obj, NumbersAreThoseOfTheCLibrary) {
    std::mt19937 random(1);
    std::string text;
    std::vector<float> expected;
    for (int i = 0; i < 20000; ++i) {
        std::string word;
        for (std::size_t length = 1 + random() % 7; word.size() < length;) word += "0123456789..--+eE"[random() % 17];
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        EXPECT_EQ(is_finite_number(word), *end == '\0') << word;
        if (*end != '\0' || !(std::abs(value) < 1e38) || (value != 0. && std::abs(value) < 1e-30)) continue;
        text += "v 0 0 " + word + "\n";
        expected.push_back(float(value));
    }
    ASSERT_GT(expected.size(), 1000u);
    for (std::size_t i = 1; i <= expected.size(); ++i) text += "f 1 2 " + std::to_string(i) + "\n";
    const Mesh mesh = load(text).meshes.at(0);
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(mesh.positions[mesh.triangles[i].z].z, expected[i], 1e-6 * std::abs(expected[i]));
}

TEST_F(Obj, FacesOfTwoVerticesAreLeftOutWithAWarning) {
    const Scene scene = load(unit_square + "f 1 2\nf 1\nf 1 2 3\n");
    EXPECT_EQ(triangle_count(scene), 1u);
    EXPECT_TRUE(warned("2 faces with fewer than 3"));
}

TEST_F(Obj, MissingFileIsAnError) {
    expect_error(ErrorKind::user, {"absent.obj", "No such file"},
                 [&] { static_cast<void>(load_obj(folder / "absent.obj", warnings)); });
    expect_error(ErrorKind::user, {"not a regular file"},
                 [&] { static_cast<void>(load_obj(std::filesystem::temp_directory_path(), warnings)); });
}

TEST_F(Obj, EmptyFileIsAnError) {
    expect_error(ErrorKind::user, {"mesh.obj", "is empty"}, [&] { load(""); });
}

TEST_F(Obj, FileWithoutFacesIsAnError) {
    EXPECT_EQ(load(unit_square).primitives.at(0).points.size(), 4u) << "a cloud of points";
    expect_error(ErrorKind::user, {"mesh.obj", "neither faces nor points"}, [&] { load("vn 0 0 1\n"); });
    expect_error(ErrorKind::user, {"neither faces nor points"}, [&] {
        load(
            std::string("\0\x7f"
                        "ELF\1\2\3",
                        8));
    });
}

TEST_F(Obj, IndexOutOfRangeNamesTheLine) {
    expect_error(ErrorKind::user, {"mesh.obj", "line 6", "vertex index 5", "there are 4"},
                 [&] { load(unit_square + "f 1 2 3\nf 1 2 5\nf 1 2 4\n"); });
    expect_error(ErrorKind::user, {"line 5", "vertex index 5"}, [&] { load(unit_square + "f 1 2 5\nf 2 3 5\n"); });
    EXPECT_EQ(load(unit_square + "f +1 +2 +3\n").meshes.at(0).triangles.at(0), glm::uvec3(0, 1, 2));
    expect_error(ErrorKind::user, {"line 5", "vertex index -5"}, [&] { load(unit_square + "f -1 -2 -5\n"); });
    expect_error(ErrorKind::user, {"line 5", "vertex index 0"}, [&] { load(unit_square + "f 0 1 2\n"); });
    expect_error(ErrorKind::user, {"line 6", "texture index 2"},
                 [&] { load(unit_square + "vt 0 0\nf 1/1 2/2 3/1\n"); });
    expect_error(ErrorKind::user, {"line 6", "normal index 2"},
                 [&] { load(unit_square + "vn 0 0 1\nf 1//1 2//1 3//2\n"); });
    expect_error(ErrorKind::user, {"vertex index 2147483647"}, [&] { load(unit_square + "f 1 2 2147483647\n"); });
    expect_error(ErrorKind::user, {"vertex index -2147483648"}, [&] { load(unit_square + "f 1 2 -2147483648\n"); });
}

TEST_F(Obj, SceneNamesAreBuiltInOrFiles) {
    EXPECT_EQ(load_scene("cornell", warnings).name, "cornell");
    EXPECT_EQ(triangle_count(load_scene(folder.file("A.OBJ", unit_square + "f 1 2 3\n").string(), warnings)), 1u);
    expect_error(ErrorKind::usage, {"unknown scene 'teapot'", "cornell", "soup:N"},
                 [&] { static_cast<void>(load_scene("teapot", warnings)); });
    expect_error(ErrorKind::user, {"mesh.fbx", "No such file"},
                 [&] { static_cast<void>(load_scene("mesh.fbx", warnings)); });
    expect_error(ErrorKind::user, {"absent.obj"}, [&] { static_cast<void>(load_scene("absent.obj", warnings)); });
}

/// Where float32 rounds them by more than 1e-5 of the extent.
TEST_F(Obj, CoordinatesFarFromTheOriginAreWarnedOf) {
    const auto warnings_at = [&](double x, double y, double size) {
        const std::string text =
            printed("v %.9g %.9g 0\nv %.9g %.9g 0\nv %.9g %.9g 0\nf 1 2 3\n", x, y, x + size, y, x, y + size);
        warnings.clear();
        static_cast<void>(load_scene(folder.file("map.obj", text).string(), warnings));
        return std::count_if(warnings.begin(), warnings.end(), [](const std::string& line) {
            return line.find("map.obj") != std::string::npos && line.find("float32 rounds") != std::string::npos;
        });
    };
    EXPECT_EQ(warnings_at(447123.05, 4132567.15, 2), 1);
    EXPECT_EQ(warnings_at(-4e6, 0, 2), 1);
    EXPECT_EQ(warnings_at(0.05, 0.15, 2), 0);
    EXPECT_EQ(warnings_at(1e9, 1e9, 1e8), 0) << "as wide as it is far";
    EXPECT_EQ(warnings_at(100, 0, 1), 0);
}

TEST_F(Obj, AMeshWithoutLightGetsASky) {
    const Scene scene = load(unit_square + "f 1 2 3\n");
    EXPECT_EQ(scene.environment.images.size(), 1u);
    EXPECT_TRUE(warned("added a neutral studio as light"));
}

}  // namespace
}  // namespace claray
