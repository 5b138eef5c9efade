// Kinds of images that stb_image does not read, and the names of those that claray does not read, either.
#include <gtest/gtest.h>

#include <cmath>

#include "claray/io.hpp"
#include "host/io/image/image_file.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/base64.hpp"
#include "tests/io/image/broken_bytes.hpp"
#include "tests/io/image/encoded_images.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::TemporaryFolder;
using Bytes = std::vector<std::uint8_t>;
using Floats = std::vector<float>;
using namespace std::string_literals;

class ImageFormats : public ::testing::Test {
protected:
    Texture load(const std::string& bytes) { return load_image(folder.file("image.any", bytes)); }
    void refuse(const std::string& bytes, std::initializer_list<std::string> words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(load(bytes)); });
    }
    TemporaryFolder folder;
};

std::string as_text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

/// Pixels of value v / 128 in red, and 0 in green and blue.
std::string red_pixels(const Bytes& values) {
    std::string text;
    for (const std::uint8_t value : values) text += as_text({value, 0, 0, 129});
    return text;
}
std::string radiance_file(const std::string& variables, const std::string& size, const std::string& pixels) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + variables + "\n" + size + "\n" + pixels;
}
Floats reds_of(const Texture& texture) {
    Floats reds;
    for (std::size_t i = 0; i < texture.floats.size(); i += 3) reds.push_back(128 * texture.floats[i]);
    return reds;
}

/// 1 1 1 n repeats a pixel, and two of them in a row are a number of two digits to the base 256.
TEST_F(ImageFormats, RadianceOfOldRuns) {
    const std::string few = red_pixels({130, 140}) + as_text({1, 1, 1, 2}) + red_pixels({150});
    EXPECT_EQ(reds_of(load(radiance_file("", "-Y 1 +X 5", few))), (Floats{130, 140, 140, 140, 150}));
    const std::string many = red_pixels({130}) + as_text({1, 1, 1, 3, 1, 1, 1, 1}) + red_pixels({150});
    const Texture wide = load(radiance_file("", "-Y 1 +X 261", many));
    EXPECT_EQ(reds_of(wide), [] {
        Floats all(260, 130);
        all.push_back(150);
        return all;
    }());
    refuse(radiance_file("", "-Y 1 +X 3", few), {"image.any", "runs are longer"});
    refuse(radiance_file("", "-Y 1 +X 5", as_text({1, 1, 1, 5})), {"image.any", "runs are longer"});
    refuse(radiance_file("", "-Y 2 +X 3", few.substr(0, 12)), {"image.any", "cut off"});
}

TEST_F(ImageFormats, RadianceInAllOrders) {
    const std::string six = red_pixels({131, 132, 133, 134, 135, 136});
    const std::pair<const char*, Floats> orders[] = {
        {"-Y 2 +X 3", {131, 132, 133, 134, 135, 136}}, {"+Y 2 +X 3", {134, 135, 136, 131, 132, 133}},
        {"-Y 2 -X 3", {133, 132, 131, 136, 135, 134}}, {"+Y 2 -X 3", {136, 135, 134, 133, 132, 131}},
        {"+X 3 -Y 2", {131, 133, 135, 132, 134, 136}}, {"+X 3 +Y 2", {132, 134, 136, 131, 133, 135}},
        {"-X 3 -Y 2", {135, 133, 131, 136, 134, 132}}, {"-X 3 +Y 2", {136, 134, 132, 135, 133, 131}}};
    for (const auto& [size, expected] : orders) {
        const Texture texture = load(radiance_file("", size, six));
        EXPECT_EQ(texture.width, 3u);
        EXPECT_EQ(texture.height, 2u);
        EXPECT_EQ(reds_of(texture), expected) << size;
    }
    for (const char* size : {"-Y 2 +Y 3", "-Y 2", "Y 2 X 3", "-Y 0 +X 3", "-Y 2 +X -3", "-Y 2 +Z 3"})
        refuse(radiance_file("", size, six), {"image.any", "size"});
}

/// A picture holds the radiance times the exposures of all programs that scaled it.
TEST_F(ImageFormats, RadianceOfAnExposure) {
    const std::string pixel = as_text({128, 128, 128, 129});
    EXPECT_EQ(load(radiance_file("EXPOSURE=2\nEXPOSURE= 4.0\n", "-Y 1 +X 1", pixel)).floats,
              (Floats{.125f, .125f, .125f}));
    EXPECT_EQ(load(radiance_file("COLORCORR=1 2 4\n", "-Y 1 +X 1", pixel)).floats, (Floats{1, .5f, .25f}));
    EXPECT_EQ(load(radiance_file("EXPOSURE=0\n# EXPOSURE=2\n", "-Y 1 +X 1", pixel)).floats, (Floats{1, 1, 1}));
    refuse("#?RADIANCE\nFORMAT=64-bit\n\n-Y 1 +X 1\n" + pixel, {"image.any", "format '64-bit'"});
}

TEST_F(ImageFormats, RadianceInOtherColours) {
    const auto xyz = [&](const Bytes& pixel) {
        return load("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + as_text(pixel)).floats;
    };
    for (const float value : xyz({128, 128, 128, 129})) EXPECT_NEAR(value, 1, 1e-5) << "white stays white";
    const Floats blue = xyz({0, 0, 128, 129});  // beyond what Rec. 709 has of blue
    EXPECT_EQ(blue[0], 0.f);
    EXPECT_NEAR(blue[2], 1.151, 1e-3);
    const std::string rec2020 = "PRIMARIES= .708 .292 .17 .797 .131 .046 .3127 .329\n";
    const Floats green = load(radiance_file(rec2020, "-Y 1 +X 1", as_text({128, 128, 128, 129}))).floats;
    for (const float value : green) EXPECT_NEAR(value, 1, 1e-5);
    const Floats grey = load(radiance_file(rec2020, "-Y 1 +X 1", as_text({64, 128, 64, 129}))).floats;
    EXPECT_NEAR(grey[1], 1.0665, 1e-3);  // ITU-R BT.2087: 0.5 (-0.1246 - 0.0083) + 1.1329
}

/// Bit 4 of the descriptor.
TEST_F(ImageFormats, TgaFromRightToLeft) {
    Bytes tga = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 1, 0, 24, 0x10, 3, 2, 1, 6, 5, 4, 9, 8, 7};
    EXPECT_EQ(load(as_text(tga)).bytes, (Bytes{7, 8, 9, 4, 5, 6, 1, 2, 3}));
    tga[17] = 0x30;
    EXPECT_EQ(load(as_text(tga)).bytes, (Bytes{7, 8, 9, 4, 5, 6, 1, 2, 3})) << "one row from above";
}

/// A BMP of 4 colours, of grey levels 0, 10, 20 and 30.
std::string bmp_of_runs(unsigned bits, unsigned width, unsigned height, const Bytes& runs) {
    Bytes bytes = {'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, 70, 0, 0, 0, 40, 0, 0, 0};
    bytes.resize(54, 0);
    bytes[18] = std::uint8_t(width), bytes[22] = std::uint8_t(height), bytes[26] = 1;
    bytes[28] = std::uint8_t(bits), bytes[30] = bits == 8 ? 1 : 2, bytes[46] = 4;
    for (const std::uint8_t level : {0, 10, 20, 30}) bytes.insert(bytes.end(), {level, level, level, 0});
    bytes.insert(bytes.end(), runs.begin(), runs.end());
    return as_text(bytes);
}
Bytes levels_of(const Texture& texture) {
    Bytes levels;
    for (std::size_t i = 0; i < texture.bytes.size(); i += texture.channels)
        levels.push_back(std::uint8_t(texture.bytes[i] / 10));
    return levels;
}

/// Rows from the bottom up: runs, pixels as they are, jumps.
TEST_F(ImageFormats, BmpOfRuns) {
    const Bytes rle8 = {3, 1, 1, 2, 0, 0, 0, 3, 1, 2, 3, 0, 0, 0, 0, 2, 2, 0, 2, 3, 0, 1};
    EXPECT_EQ(levels_of(load(bmp_of_runs(8, 4, 3, rle8))), (Bytes{0, 0, 3, 3, 1, 2, 3, 0, 1, 1, 1, 2}));
    const Bytes rle4 = {3, 0x12, 1, 0x30, 0, 0, 0, 3, 0x12, 0x30, 0, 1};
    EXPECT_EQ(levels_of(load(bmp_of_runs(4, 4, 2, rle4))), (Bytes{1, 2, 3, 0, 1, 2, 1, 3}));
    EXPECT_EQ(levels_of(load(bmp_of_runs(8, 2, 1, {9, 1}))), (Bytes{1, 1})) << "a run beyond the image";
    std::string huge = bmp_of_runs(8, 2, 1, {2, 1});
    huge[20] = 0x10;
    refuse(huge, {"image.any"});
    for (std::size_t size = 0; size < 70; ++size) refuse(bmp_of_runs(8, 2, 1, {}).substr(0, size), {"image.any"});
}

/// stb_image fails without a reason where a scan names a component that does not exist.
TEST_F(ImageFormats, DamagedJpegsHaveAReason) {
    const std::string whole = test::from_base64(test::jpeg);
    const std::size_t scan = whole.find("\xff\xda");
    ASSERT_NE(scan, std::string::npos);
    std::string broken = whole;
    broken[scan + 5] = 99;
    refuse(broken, {"image.any", "damaged (it cannot be decoded)"});
    broken = whole;
    broken[whole.find("\xff\xc0") + 4] = 12;  // bits
    refuse(broken, {"image.any", "damaged"});
    refuse(broken + "\xff", {"image.any", "damaged"});
}

TEST_F(ImageFormats, OthersAreNamedWithAWayOut) {
    const std::pair<std::string, const char*> others[] = {{"GIF89a", "GIF"},
                                                          {"II*\0"s, "TIFF"},
                                                          {"MM\0*"s, "TIFF"},
                                                          {"\xabKTX 20\xbb\r\n\x1a\n", "KTX 2"},
                                                          {"\xabKTX 11\xbb\r\n\x1a\n", "KTX"},
                                                          {"DDS |", "DDS"},
                                                          {"8BPS\0\1"s, "Photoshop"},
                                                          {"\0\0\0\x1c"
                                                           "ftypavif"s,
                                                           "AVIF"},
                                                          {"\0\0\0\x18"
                                                           "ftypheic"s,
                                                           "HEIC"},
                                                          {"\xff\x0a", "JPEG XL"},
                                                          {"\0\0\0\x0cjP  \r\n"s, "JPEG 2000"},
                                                          {"qoif", "QOI"},
                                                          {"P6\n1 1\n255\nabc", "Netpbm"},
                                                          {"\n<svg xmlns", "SVG"}};
    for (const auto& [bytes, name] : others) refuse(bytes + std::string(64, '\0'), {"image.any", name, "PNG"});
    refuse("<!DOCTYPE html><html>", {"image.any", "web page", "download"});
    refuse("version https://git-lfs.github.com/spec/v1\n", {"image.any", "git lfs pull"});
    refuse("\x1f\x8b\x08", {"image.any", "gzip", "unpack"});
}

/// Whatever the bytes are, the result is an image that is whole, or one line.
TEST_F(ImageFormats, BrokenBytesNeverCrash) {
    const Bytes rle8 = {3, 1, 1, 2, 0, 0, 0, 3, 1, 2, 3, 0, 0, 0, 0, 2, 2, 0, 2, 3, 0, 1};
    for (const std::string& whole :
         {bmp_of_runs(8, 4, 3, rle8), bmp_of_runs(4, 7, 3, rle8),
          radiance_file("EXPOSURE=2\n", "+X 5 -Y 2", red_pixels({130, 140}) + as_text({1, 1, 1, 3}) + red_pixels({1}))})
        test::expect_whole_or_one_line(whole, 1000);
}

/// Filters leave negative texels behind, and suns overflow.
TEST_F(ImageFormats, EnvironmentsOfWrongNumbersAreCorrected) {
    write_image(folder / "a.pfm", {2, 2, {glm::vec3(3, -1, 2), glm::vec3(INFINITY), glm::vec3(NAN), glm::vec3(1)}});
    Warnings warnings;
    const Environment environment = load_environment(folder / "a.pfm", warnings);
    EXPECT_EQ(environment.images[0].floats, (Floats{3, 0, 2, 3, 3, 3, 0, 0, 0, 1, 1, 1}));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("a.pfm': 7 values are negative or not finite"), std::string::npos) << warnings[0];
    write_image(folder / "b.pfm", {1, 1, {glm::vec3(1)}});
    static_cast<void>(load_environment(folder / "b.pfm", warnings));
    EXPECT_EQ(warnings.size(), 1u);
}

}  // namespace
}  // namespace claray
