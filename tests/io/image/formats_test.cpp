// Image formats that claray reads itself, and the names of those that it does not read.
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

/// Palettes of 1 to 8 bits; the header tells fewer colours than the file has room for.
TEST_F(ImageFormats, BmpOfPalettes) {
    for (const unsigned bits : {1u, 2u, 4u, 8u}) {
        std::string bmp =
            bmp_of_runs(bits, 2, 1, {bits == 8 ? std::uint8_t(0) : std::uint8_t(1u << (8 - 2 * bits)), 1, 0, 0});
        bmp[30] = 0;
        EXPECT_EQ(levels_of(load(bmp)), (Bytes{0, 1})) << bits;
        bmp.insert(70, 30, 'x'), bmp[10] = 100;
        EXPECT_EQ(levels_of(load(bmp)), (Bytes{0, 1})) << bits << " bits and a gap before the pixels";
        bmp[46] = 1;
        EXPECT_EQ(levels_of(load(bmp)), (Bytes{0, 0})) << "a colour that the palette does not have";
    }
}

/// A BMP of pixels without a palette; `masks` follow a header of 40 bytes.
std::string bmp_of_pixels(unsigned bits, unsigned width, int height, const std::vector<std::uint32_t>& masks,
                          const Bytes& pixels) {
    const auto begin = std::uint8_t(54 + 4 * masks.size());
    Bytes bytes = {'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, begin, 0, 0, 0, 40, 0, 0, 0};
    bytes.resize(54, 0);
    bytes[18] = std::uint8_t(width), bytes[26] = 1, bytes[28] = std::uint8_t(bits);
    bytes[30] = masks.empty() ? 0 : masks.size() == 3 ? 3 : 6;
    for (std::size_t i = 0; i < 4; ++i) bytes[22 + i] = std::uint8_t(std::uint32_t(height) >> 8 * i);
    for (const std::uint32_t mask : masks)
        for (std::size_t i = 0; i < 4; ++i) bytes.push_back(std::uint8_t(mask >> 8 * i));
    bytes.insert(bytes.end(), pixels.begin(), pixels.end());
    return as_text(bytes);
}

TEST_F(ImageFormats, BmpOfMasks) {
    const Bytes blue_red = {0x1f, 0, 0, 0x7c};
    EXPECT_EQ(load(bmp_of_pixels(16, 2, 1, {}, blue_red)).bytes, (Bytes{0, 0, 255, 255, 0, 0}));
    EXPECT_EQ(load(bmp_of_pixels(16, 2, 1, {0xf800, 0x7e0, 0x1f}, {0x10, 0, 0, 0x80})).bytes,
              (Bytes{0, 0, 132, 132, 0, 0}));
    EXPECT_EQ(load(bmp_of_pixels(32, 1, 1, {0x3ff00000, 0xffc00, 0x3ff}, {0xff, 3, 0, 0})).bytes, (Bytes{0, 0, 255}));
    EXPECT_EQ(load(bmp_of_pixels(32, 1, 1, {0xff, 0xff00, 0xff0000, 0xff000000}, {1, 2, 3, 0})).bytes,
              (Bytes{1, 2, 3, 0}));
}

/// Alpha that is 0 everywhere is padding, unless a mask names it.
TEST_F(ImageFormats, BmpOf32Bits) {
    EXPECT_EQ(load(bmp_of_pixels(32, 1, 1, {}, {3, 2, 1, 0})).bytes, (Bytes{1, 2, 3, 255}));
    EXPECT_EQ(load(bmp_of_pixels(32, 2, 1, {}, {3, 2, 1, 0, 6, 5, 4, 9})).bytes, (Bytes{1, 2, 3, 0, 4, 5, 6, 9}));
    EXPECT_EQ(load(bmp_of_pixels(32, 1, -2, {}, {3, 2, 1, 8, 6, 5, 4, 9})).bytes, (Bytes{1, 2, 3, 8, 4, 5, 6, 9}))
        << "from the top";
    refuse(bmp_of_pixels(64, 1, 1, {}, Bytes(8)), {"image.any", "64 bits", "PNG"});
    refuse(bmp_of_pixels(24, 1, 2, {}, Bytes(6)), {"image.any", "cut off"});
}

/// OS/2: a header of 12 bytes, and colours of 3.
TEST_F(ImageFormats, BmpOfOs2) {
    const Bytes os2 = {'B', 'M', 0, 0, 0, 0, 0, 0, 0, 0, 32, 0, 0, 0, 12, 0, 0,   0, 1, 0,
                       2,   0,   1, 0, 1, 0, 1, 2, 3, 4, 5,  6, 0, 0, 0,  0, 128, 0, 0, 0};
    EXPECT_EQ(load(as_text(os2)).bytes, (Bytes{6, 5, 4, 3, 2, 1}));
}

/// The first of a colour map's entries may have any index; a map that the pixels do not use is skipped.
TEST_F(ImageFormats, TgaOfColourMaps) {
    Bytes tga = {0, 1, 1, 7, 0, 2, 0, 24, 0, 0, 0, 0, 3, 0, 1, 0, 8, 0x20, 3, 2, 1, 6, 5, 4, 8, 7, 8};
    EXPECT_EQ(load(as_text(tga)).bytes, (Bytes{4, 5, 6, 1, 2, 3, 4, 5, 6}));
    tga = {1, 1, 2, 0, 0, 1, 0, 24, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0x20, 99, 9, 9, 9, 3, 2, 1};
    EXPECT_EQ(load(as_text(tga)).bytes, (Bytes{1, 2, 3}));
}

TEST_F(ImageFormats, TgaOfRunsAndBits) {
    const Bytes runs = {0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x20, 0x82, 3, 2, 1, 0, 6, 5, 4};
    EXPECT_EQ(load(as_text(runs)).bytes, (Bytes{1, 2, 3, 1, 2, 3, 1, 2, 3, 4, 5, 6}))
        << "a run goes on in the next row";
    for (std::size_t size = 0; size < runs.size(); ++size) refuse(as_text(runs).substr(0, size), {"image.any"});
    const Bytes five = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 16, 0x20, 0x1f, 0, 0, 0x7c};
    EXPECT_EQ(load(as_text(five)).bytes, (Bytes{0, 0, 255, 255, 0, 0}));
    const Bytes grey = {0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 16, 0x20, 7, 8};
    EXPECT_EQ(load(as_text(grey)).bytes, (Bytes{7, 8})) << "with alpha";
    Bytes rgba = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32, 0x28, 3, 2, 1, 0};
    EXPECT_EQ(load(as_text(rgba)).bytes, (Bytes{1, 2, 3, 0}));
    rgba[17] = 0x20;
    EXPECT_EQ(load(as_text(rgba)).bytes, (Bytes{1, 2, 3, 255})) << "padding instead of alpha";
}

/// Two bytes of 2 are a pixel, too, where no row of this length begins so.
TEST_F(ImageFormats, RadianceOfDarkPixels) {
    const std::string dark = as_text({2, 2, 7, 128}), row = dark + dark + dark + dark;
    EXPECT_EQ(load(radiance_file("", "-Y 1 +X 8", row + row)).floats.at(2), 7 / 256.f);
}

TEST_F(ImageFormats, PfmOfAScale) {
    write_image(folder / "a.pfm", {1, 1, {glm::vec3(1, 2, 3)}});
    std::string bytes = test::read_file(folder / "a.pfm");
    bytes.replace(bytes.find("1.0\n"), 3, "2.5");
    EXPECT_EQ(load(bytes).floats, (Floats{2.5, 5, 7.5}));
    bytes.replace(bytes.find("2.5\n"), 3, "0.0");
    refuse(bytes, {"image.any", "header is damaged"});
}

TEST_F(ImageFormats, OthersAreNamedWithAWayOut) {
    const std::pair<std::string, const char*> others[] = {{"GIF89a", "GIF"},
                                                          {"II*\0"s, "TIFF"},
                                                          {"MM\0*"s, "TIFF"},
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
                                                          {"icns", "ICNS"},
                                                          {"\x0a\5\1\x08"s, "PCX"},
                                                          {"\0\0\2\0\1\0"s, "CUR"},
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
          bmp_of_pixels(16, 2, -2, {0x7c00, 0x3e0, 7}, Bytes(8)),
          as_text({0, 1, 9, 7, 0, 2, 0, 24, 0, 0, 0, 0, 3, 0, 1, 0, 8, 0x30, 3, 2, 1, 6, 5, 4, 0x81, 7, 0, 8}),
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
