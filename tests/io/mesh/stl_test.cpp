// STL, text and binary.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::TemporaryFolder;

/// Two triangles of a square; `count` is what the header says.
std::string binary_solid(std::uint32_t count = 2, const std::string& comment = "solid, but binary") {
    std::string bytes = comment;
    bytes.resize(80, '\0');
    for (int k = 0; k < 4; ++k) bytes.push_back(char(count >> (8 * k)));
    const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, -0.f, 1, 1, 0, 0, 1, 0}};
    for (const auto& triangle : corners) {
        const float normal[3] = {0, 0, 1};
        bytes.append(reinterpret_cast<const char*>(normal), 12);
        bytes.append(reinterpret_cast<const char*>(triangle), 36);
        bytes.append(2, '\0');
    }
    return bytes;
}

const std::string solid_of_text =
    "solid left half\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n  "
    "endloop\n endfacet\n"
    "endsolid left half\nSOLID\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1E0 +1 0\nVERTEX 0 1 "
    "0\nENDLOOP\nENDFACET\n"
    "ENDSOLID\n";

TEST(Stl, BinaryVerticesAreShared) {
    const TemporaryFolder folder;
    Warnings warnings;
    const Scene scene = load_scene(folder.file("square.stl", binary_solid()), warnings);
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 4u);
    EXPECT_EQ(scene.meshes[0].triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(1, 1, 0));
    EXPECT_EQ(scene.meshes[0].name, "square");
}

TEST(Stl, SolidsOfATextAreMeshes) {
    const TemporaryFolder folder;
    Warnings warnings;
    const Scene scene = load_stl(folder.file("two.stl", solid_of_text), warnings);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].name, "left half");
    EXPECT_EQ(scene.meshes[1].name, "two");
    EXPECT_EQ(scene.meshes[1].positions[1], glm::vec3(1, 1, 0));
    EXPECT_EQ(scene.meshes[0].triangles.size() + scene.meshes[1].triangles.size(), 2u);
}

TEST(Stl, NotANumberStaysAlone) {
    const TemporaryFolder folder;
    Warnings warnings;
    std::string bytes = binary_solid();
    const float nan = NAN;
    std::memcpy(bytes.data() + 84 + 12, &nan, sizeof nan);
    EXPECT_EQ(load_stl(folder.file("nan.stl", bytes), warnings).meshes[0].positions.size(), 5u);
}

TEST(Stl, DamagedFilesAreRefusedByTheirPlace) {
    const TemporaryFolder folder;
    Warnings warnings;
    const auto refused = [&](const std::string& bytes, const std::vector<std::string>& words) {
        SCOPED_TRACE(words.back());
        expect_error(ErrorKind::user, words, [&] { (void)load_stl(folder.file("bad.stl", bytes), warnings); });
    };
    refused("", {"is empty"});
    refused(binary_solid(3), {"cut off", "184 bytes", "3 triangles take 234"});
    refused(binary_solid(0xffffffffu), {"cut off", "4294967295 triangles"});
    refused(binary_solid(0, "binary").substr(0, 84), {"contains no triangle"});
    refused("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 O\n", {"line 4", "'o' is not a number"});
    refused("solid a\nfacet normal 0 0 1\nouter ring\n", {"line 3", "'ring' is not 'loop'"});
    refused(solid_of_text.substr(0, solid_of_text.find("vertex 1 0 0") + 8), {"line 5", "cut off"});
    refused("solid a\nendsolid a\n", {"contains no triangle"});
    refused("hello", {"line 1", "'hello' is not 'solid'"});
    refused("solid a\n\x1f", {"line 2"});
}

}  // namespace
}  // namespace claray
