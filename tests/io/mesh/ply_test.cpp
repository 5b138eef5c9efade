// PLY in all three encodings, against the same mesh; what it may hold besides, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::TemporaryFolder;

template <class T>
void put(std::string& bytes, T value, bool big) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof raw);
    if (big) std::reverse(raw, raw + sizeof raw);
    bytes.append(raw, sizeof raw);
}

const char* const header_after_format =
    "comment made by hand\nobj_info x\nelement vertex 4\nproperty double x\nproperty float y\nproperty short z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\nproperty "
    "float nz\n"
    "element other 1\nproperty list uint8 float values\nproperty int tag\n"
    "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\nend_header\n";

/// A square of the corners (0, 0, 3) .. (1, 1, 3), red at the first, as a triangle and as a polygon of four corners.
std::string binary_square(bool big) {
    std::string bytes = std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") + " 1.0\n" +
                        header_after_format;
    for (int i = 0; i < 4; ++i) {
        put(bytes, double(i == 1 || i == 2), big), put(bytes, float(i >= 2), big), put(bytes, std::int16_t(3), big);
        put(bytes, std::uint8_t(255), big), put(bytes, std::uint8_t(i ? 255 : 0), big),
            put(bytes, std::uint8_t(i ? 255 : 0), big);
        put(bytes, 0.f, big), put(bytes, 0.f, big), put(bytes, 2.f, big);
    }
    put(bytes, std::uint8_t(2), big), put(bytes, 1.f, big), put(bytes, 2.f, big), put(bytes, 7, big);
    put(bytes, std::uint8_t(0), big), put(bytes, std::uint8_t(3), big);
    for (const int index : {0, 1, 2}) put(bytes, index, big);
    put(bytes, std::uint8_t(0), big), put(bytes, std::uint8_t(4), big);
    for (const int index : {3, 2, 1, 0}) put(bytes, index, big);
    return bytes;
}

std::string text_square() {
    return std::string("ply\r\nformat ascii 1.0\r\n") + header_after_format +
           "0 0 3 255 0 0 0 0 2\n1 +0 3 255 255 255 0 0 2\n1e0 1 3 255 255 255 0 0 2\n0 1 3 255 255 255 0 0 2\n"
           "2 1 2 7\n0 3 0 1 2\n0 4 3 2 1 0";
}

void expect_square(const Scene& scene) {
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[2], glm::vec3(1, 1, 3));
    EXPECT_EQ(mesh.positions[3], glm::vec3(0, 1, 3));
    ASSERT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(mesh.triangles[0], glm::uvec3(0, 1, 2));
    for (std::size_t i = 1; i < 3; ++i) {  // of the polygon: seen from below
        const glm::uvec3 t = mesh.triangles[i];
        EXPECT_LT(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).z,
                  0.f);
    }
    ASSERT_EQ(mesh.colors.size(), 4u);
    EXPECT_EQ(mesh.colors[0], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(mesh.colors[1], glm::vec4(1));
    ASSERT_EQ(mesh.normals.size(), 4u);
    EXPECT_EQ(mesh.normals[1], glm::vec3(0, 0, 1));
}

TEST(Ply, AllEncodingsGiveTheSameMesh) {
    const TemporaryFolder folder;
    Warnings warnings;
    expect_square(load_ply(folder.file("little.ply", binary_square(false)), warnings));
    expect_square(load_ply(folder.file("big.ply", binary_square(true)), warnings));
    expect_square(load_scene(folder.file("text.PLY", text_square()), warnings));
}

TEST(Ply, StripsOfStanfordAlternate) {
    const TemporaryFolder folder;
    Warnings warnings;
    const auto path =
        folder.file("strips.ply",
                    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                    "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 2 1 3\n");
    const Scene scene = load_ply(path, warnings);
    EXPECT_EQ(scene.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {2, 1, 3}, {2, 1, 3}}));
}

TEST(Ply, TextureCoordinatesCountFromTheTop) {
    const TemporaryFolder folder;
    Warnings warnings;
    const Scene scene = load_ply(
        folder.file(
            "uv.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "property float s\nproperty float t\nelement face 2\nproperty list uchar uint vertex_index\nend_header\n"
            "0 0 0 0 0.25\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n2 0 1\n"),
        warnings);
    EXPECT_EQ(scene.meshes[0].uvs[0], glm::vec2(0, 0.75f));
    EXPECT_NE(std::find_if(warnings.begin(), warnings.end(), [](auto& w) { return w.find("fewer than 3") != w.npos; }),
              warnings.end());
}

TEST(Ply, DamagedFilesAreRefusedByTheirPlace) {
    const TemporaryFolder folder;
    Warnings warnings;
    const std::string good = text_square(), binary = binary_square(false);
    const auto replaced = [&](std::string text, const std::string& what, const std::string& by) {
        const std::size_t at = text.find(what);
        EXPECT_NE(at, text.npos) << what;
        return text.replace(at, what.size(), by);
    };
    const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
        {"", {"is empty"}},
        {"PLY?\n", {"line 1", "'ply'"}},
        {"ply\nformat ascii 1.0\n", {"line 2", "within its header"}},
        {replaced(good, "ascii", "utf8"), {"line 2", "utf8"}},
        {replaced(good, "vertex 4", "vertex four"), {"line 5", "four"}},
        {replaced(good, "short", "half"), {"line 8", "half"}},
        {replaced(good, "element vertex 4", "element vertex 4000000000"), {"cut off", "vertex"}},
        {replaced(good, "1e0", "1,5"), {"line 24", "1,5"}},
        {replaced(good, "0 3 0 1 2", "0 3 0 1 4"), {"vertex index 4", "4 vertices"}},
        {replaced(good, "0 3 0 1 2", "0 3 0 1 -1"), {"vertex index -1"}},
        {good.substr(0, good.size() - 2), {"cut off"}},
        {binary.substr(0, binary.size() - 1), {"element 'face'", "row 1", "cut off"}},
        {replaced(good, "double x", "double w"), {"lack x, y or z"}},
        {replaced(good, "vertex_indices", "corners"), {"vertex_indices"}},
        {replaced(good, "0 3 0 1 2", "0 3 0 1"), {"line 27", "the row lacks values"}},
        {"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
         {"neither faces nor points"}}};
    for (const auto& [bytes, words] : cases) {
        SCOPED_TRACE(words.back());
        expect_error(ErrorKind::user, words, [&] { (void)load_ply(folder.file("bad.ply", bytes), warnings); });
    }
}

}  // namespace
}  // namespace claray
