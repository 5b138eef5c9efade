// PNG of every colour type and depth: texels by the specification's own words, from files put together here.
#include "tests/support/png.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>

#include "host/io/image/image_file.hpp"
#include "tests/io/expect_error.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::RawPng;

Texture decoded(const std::string& file) { return decode_texture(file, "it", TexelFormat::linear8); }

struct Kind {
    unsigned color_type, depth;
};

class Png : public testing::TestWithParam<std::tuple<Kind, bool, bool>> {
protected:
    [[nodiscard]] static RawPng png() {
        const auto [kind, interlaced, transparent] = GetParam();
        RawPng png;
        png.width = 13, png.height = 11, png.depth = kind.depth, png.color_type = kind.color_type;
        png.interlaced = interlaced;
        const unsigned most = (1u << png.depth) - 1;
        for (unsigned i = 0; i < png.width * png.height * png.channels(); ++i)
            png.samples.push_back(std::uint16_t((i * 40503u >> 3) & most));
        if (png.color_type == 3)
            for (unsigned i = 0; i <= most; ++i)
                for (const unsigned value : {i * 7 + 1, i * 3 + 100, 255 - i}) png.palette += char(value & 255);
        if (!transparent) return png;
        if (png.color_type == 3)
            for (unsigned i = 0; i <= most / 2; ++i) png.transparency += char(i * 50 & 255);
        for (unsigned c = 0; c < png.channels() && png.color_type != 3; ++c) {
            const std::uint16_t value = png.samples[5 * png.channels() + c];  // that of the sixth pixel
            png.transparency += {char(value >> 8), char(value & 255)};
        }
        return png;
    }

    /// The values of one pixel in 0..1, alpha last.
    [[nodiscard]] static std::vector<double> expected(const RawPng& png, std::size_t pixel) {
        const unsigned channels = png.channels(), most = (1u << png.depth) - 1;
        const std::uint16_t* const samples = &png.samples[pixel * channels];
        std::vector<double> values;
        const auto byte = [](char c) { return double(std::uint8_t(c)) / 255; };
        if (png.color_type == 3) {
            for (unsigned c = 0; c < 3; ++c) values.push_back(byte(png.palette[samples[0] * 3u + c]));
            if (!png.transparency.empty())
                values.push_back(samples[0] < png.transparency.size() ? byte(png.transparency[samples[0]]) : 1.0);
            return values;
        }
        bool is_key = true;
        for (unsigned c = 0; c < channels; ++c) {
            values.push_back(double(samples[c]) / most);
            is_key = is_key && samples[c] == png.samples[5 * channels + c];
        }
        if (!png.transparency.empty()) values.push_back(is_key ? 0.0 : 1.0);
        return values;
    }
};

TEST_P(Png, HasTheTexelsOfTheSpecification) {
    const RawPng png = Png::png();
    if (!std::get<2>(GetParam()) || png.color_type < 4) {  // alpha and tRNS exclude each other
        const Texture texture = decoded(png.file());
        ASSERT_EQ(texture.width, png.width);
        ASSERT_EQ(texture.height, png.height);
        const bool real = png.depth == 16;
        EXPECT_EQ(texture.format, real ? TexelFormat::float32 : TexelFormat::linear8);
        ASSERT_EQ(texture.channels, expected(png, 0).size());
        ASSERT_EQ(texture.bytes.size() + texture.floats.size(), std::size_t(texture.channels) * png.width * png.height);
        for (std::size_t i = 0; i < std::size_t(png.width) * png.height; ++i) {
            const std::vector<double> values = expected(png, i);
            for (std::size_t c = 0; c < values.size(); ++c) {
                const std::size_t at = i * values.size() + c;
                const double value = real ? double(texture.floats[at]) : texture.bytes[at] / 255.0;
                ASSERT_NEAR(value, values[c], 1e-6) << "pixel " << i << ", channel " << c;
            }
        }
    }
}

std::string name_of(const std::tuple<Kind, bool, bool>& what) {
    const auto [kind, interlaced, transparent] = what;
    return "Type" + std::to_string(kind.color_type) + "Depth" + std::to_string(kind.depth) +
           (interlaced ? "Interlaced" : "") + (transparent ? "Transparent" : "");
}

INSTANTIATE_TEST_SUITE_P(All, Png,
                         testing::Combine(testing::Values(Kind{0, 1}, Kind{0, 2}, Kind{0, 4}, Kind{0, 8}, Kind{0, 16},
                                                          Kind{2, 8}, Kind{2, 16}, Kind{3, 1}, Kind{3, 2}, Kind{3, 4},
                                                          Kind{3, 8}, Kind{4, 8}, Kind{4, 16}, Kind{6, 8}, Kind{6, 16}),
                                          testing::Bool(), testing::Bool()),
                         [](const auto& kind) { return name_of(kind.param); });

TEST(PngLimits, AWideImageOfOneBitIsNoSuspect) {
    RawPng png;
    png.width = 2048, png.height = 2048, png.depth = 1, png.color_type = 3;
    png.palette = "abcdef", png.transparency = "g";
    const std::string file = png.file_with(test::zeros_zlib(2048 * 257));
    EXPECT_LT(file.size(), 4000u) << "4,000 texels of 4 bytes for each byte";
    const Texture texture = decoded(file);
    EXPECT_EQ(texture.channels, 4u);
    EXPECT_EQ(texture.bytes.size(), 4u << 22);
}

std::size_t most_memory() {
    struct rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return std::size_t(usage.ru_maxrss) * 1024;
}

// 64 MB of zeros for a single pixel. What is behind the pixels is not looked at.
TEST(PngLimits, WhatInflatesBeyondTheHeadersSizeIsStoppedThere) {
    const std::string bomb = RawPng().file_with(test::zeros_zlib(1u << 26));
    ASSERT_LT(bomb.size(), 1u << 19);
    const std::size_t before = most_memory();
    EXPECT_EQ(decoded(bomb).bytes, std::vector<std::uint8_t>{0});
    EXPECT_LT(most_memory() - before, 8u << 20);
}

TEST(PngLimits, CompressedTextsAndProfilesAreSkipped) {
    RawPng png;
    png.samples = {77};
    std::string file = png.file();
    const std::string text = test::png_chunk("zTXt", std::string("name\0\0", 6) + test::zeros_zlib(1u << 24)),
                      profile = test::png_chunk("iCCP", std::string("name\0\0", 6) + test::zeros_zlib(1u << 24));
    file.insert(8 + 25, text + profile);
    // libpng itself refuses what is that large, and keeps no text that begins with 0: others below its limit, many of
    // them.
    const std::string letters = test::png_chunk("zTXt", std::string("name\0\0", 6) + test::zeros_zlib(1u << 22, 'a'));
    for (int i = 0; i < 32; ++i) file.insert(8 + 25, letters);
    const std::size_t before = most_memory();
    EXPECT_EQ(decoded(file).bytes, std::vector<std::uint8_t>{77});
    EXPECT_LT(most_memory() - before, 8u << 20);
}

TEST(PngLimits, TooFewPixelsAreRefused) {
    RawPng png;
    png.width = 9, png.height = 9, png.samples.assign(81, 5);
    std::string raw = png.raw();
    EXPECT_EQ(decoded(png.file()).bytes.size(), 81u);
    raw.pop_back();
    expect_error(ErrorKind::user, {"it", "damaged"},
                 [&] { static_cast<void>(decoded(png.file_with(test::stored_zlib(raw)))); });
    png.width = png.height = 16000;  // and no 256 MB are asked for before that shows
    const std::size_t before = most_memory();
    expect_error(ErrorKind::user, {"it is cut off", "16000x16000"},
                 [&] { static_cast<void>(decoded(png.file_with(test::stored_zlib(raw)))); });
    EXPECT_LT(most_memory() - before, 8u << 20);
}

}  // namespace
}  // namespace claray
