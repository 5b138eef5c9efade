// PCD: text, binary and compressed, and files that are refused by their names.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "host/io/points/pcd_file.hpp"
#include "tests/io/expect_error.hpp"

namespace claray {
namespace {

using test::expect_error;
using Pcd = test::ReaderTest;

/// Three points, of which one is nowhere; x, y, z and packed colours.
struct PcdPoint {
    float x, y, z;
    std::uint32_t color;
};
constexpr PcdPoint three_points[] = {{1, 2, 3, 0xff8000}, {NAN, 0, 0, 0}, {-4, 5, 0.5f, 0x0000ff}};

std::string pcd_header(const std::string& data, const std::string& color = "U") {
    return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F " + color +
           "\nCOUNT 1 1 1 1\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA " + data + "\n";
}

std::string pcd_binary() {
    return pcd_header("binary") + std::string(reinterpret_cast<const char*>(three_points), sizeof three_points);
}

std::string pcd_word(std::uint32_t value) { return {reinterpret_cast<const char*>(&value), 4}; }

/// LZF that is all literals but for its last bytes, which repeat.
std::string pcd_compressed() {
    std::string fields;
    for (std::size_t field = 0; field < 4; ++field)
        for (const PcdPoint& point : three_points) fields.append(reinterpret_cast<const char*>(&point) + 4 * field, 4);
    std::string packed;
    for (std::size_t at = 0; at < fields.size(); at += 16) packed += char(15), packed += fields.substr(at, 16);
    return pcd_header("binary_compressed") + pcd_word(std::uint32_t(packed.size())) +
           pcd_word(std::uint32_t(fields.size())) + packed;
}

void expect_points(const Scene& scene) {
    ASSERT_EQ(scene.primitives.size(), 1u);
    const PrimitiveSet& spheres = scene.primitives[0];
    ASSERT_TRUE(spheres.kind == PrimitiveSet::Kind::spheres);
    ASSERT_EQ(spheres.points.size(), 2u);
    EXPECT_EQ(glm::vec3(spheres.points[0]), glm::vec3(1, 2, 3));
    EXPECT_EQ(glm::vec3(spheres.points[1]), glm::vec3(-4, 5, 0.5f));
    ASSERT_EQ(spheres.colors.size(), 4u);
    EXPECT_FLOAT_EQ(spheres.colors[0].x, 1.f);
    EXPECT_NEAR(spheres.colors[0].y, std::pow((128 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
    EXPECT_FLOAT_EQ(spheres.colors[0].z, 0.f);
    EXPECT_FLOAT_EQ(spheres.colors[2].z, 1.f);
}

TEST_F(Pcd, TextBinaryAndCompressedAreTheSame) {
    const std::string text = pcd_header("ascii") + "1 2 3 16744448\nnan 0 0 0\n-4 5 5e-1 255\n";
    std::string real = pcd_header("ascii", "F");
    for (const PcdPoint& p : three_points) {
        char line[100];
        std::snprintf(line, sizeof line, "%g %g %g %.9g\n", double(p.x), double(p.y), double(p.z),
                      double(std::bit_cast<float>(p.color)));
        real += line;
    }
    for (const std::string& bytes : {text, real, pcd_binary(), pcd_compressed()})
        for (const char* name : {"a.pcd", "cloud"})
            expect_points(load_scene(folder.file(name, bytes).string(), warnings));
    EXPECT_GT(warned("spheres"), 0u);
}

TEST_F(Pcd, RadiusIsChosen) {
    const Scene scene = load_scene(folder.file("a.pcd", pcd_binary()).string(), warnings, {.stroke_radius = 0.25f});
    EXPECT_EQ(scene.primitives.at(0).points.at(0).w, 0.25f);
}

TEST_F(Pcd, WhatIsDamagedIsRefused) {
    const auto refuse = [&](const std::string& bytes, const std::string& what) {
        expect_error(ErrorKind::user, {"a.pcd'", what},
                     [&] { static_cast<void>(load_scene(folder.file("a.pcd", bytes).string(), warnings)); });
    };
    const auto changed = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    refuse("", "empty");
    refuse(pcd_header("ascii") + "1 2 3 4\n", "cut off after 1 points");
    refuse(pcd_header("ascii") + "1 2 3\n1 2 3 4\n1 2 3 4\n", "line 12: a value is missing");
    refuse(pcd_header("ascii") + "1 2 x 4\n", "'x' is not a number");
    refuse(pcd_binary().substr(0, pcd_binary().size() - 1), "cut off");
    refuse(changed(pcd_binary(), "POINTS 3", "POINTS 400000000000"), "cut off");
    refuse(changed(pcd_binary(), "SIZE 4 4 4 4", "SIZE 4 4 4 3"), "type that no PCD has");
    refuse(changed(pcd_binary(), "FIELDS x y", "FIELDS x w"), "lack x, y or z");
    refuse(changed(pcd_binary(), "DATA binary", "DATA secret"), "unknown form 'secret'");
    refuse(changed(pcd_binary(), "POINTS 3", "POINTS x"), "'x' is no number of POINTS");
    refuse(pcd_compressed().substr(0, pcd_compressed().size() - 5), "cut off");
    refuse(changed(pcd_compressed(), pcd_word(48), pcd_word(64)), "not those of 3 points");
    refuse(pcd_header("ascii") + "nan 2 3 4\nnan 2 3 4\ninf 2 3 4\n", "no point that is finite");
}

TEST(Lzf, CopiesAndLimits) {
    EXPECT_EQ(lzf_decompressed(std::string("\0a\x20\0", 4), 4), "aaaa");
    EXPECT_EQ(lzf_decompressed(std::string("\2abc\xe0\x05\2", 7), 17), "abcabcabcabcabcab") << "7 + 5 + 2 more";
    EXPECT_EQ(lzf_decompressed(std::string("\0a\x20\1", 4), 4), "") << "before the begin";
    EXPECT_EQ(lzf_decompressed(std::string("\0a\x20\0", 4), 3), "") << "beyond the end";
    EXPECT_EQ(lzf_decompressed("\5abc", 6), "") << "cut off";
    EXPECT_EQ(lzf_decompressed("\x20", 3), "");
}

TEST_F(Pcd, GaussianSplatsAreNamed) {
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "property float f_dc_0\nend_header\n0 0 0 1\n";
    for (const auto& [name, bytes] :
         {std::pair<const char*, std::string>{"a.ply", ply}, {"a.splat", "x"}, {"a.spz", "x"}})
        expect_error(ErrorKind::user, {name, "Gaussian splats", "export a mesh"},
                     [&, path = folder.file(name, bytes).string()] { static_cast<void>(load_scene(path, warnings)); });
}

}  // namespace
}  // namespace claray
