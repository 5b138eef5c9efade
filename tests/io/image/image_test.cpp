// Images written, and read back by other code.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

using test::expect_error;
using test::TemporaryFolder;

/// Every pixel differs, so that a flipped, shifted or transposed image can't pass.
Image test_image(unsigned width = 7, unsigned height = 5) {
    Image image{width, height, {}};
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x)
            image.pixels.emplace_back(float(x) / float(width), float(y) / float(height), float(x * y + 1) * 0.02f);
    return image;
}

template <class T>
struct Freed {
    void operator()(T* memory) const { stbi_image_free(memory); }
};
std::vector<std::uint8_t> read_png(const std::filesystem::path& path, int& width, int& height) {
    int channels = 0;
    const std::unique_ptr<stbi_uc, Freed<stbi_uc>> data(stbi_load(path.c_str(), &width, &height, &channels, 3));
    if (!data) return {};
    return {data.get(), data.get() + 3 * width * height};
}

TEST(Image, PngHoldsTheExactSrgbValues) {
    const TemporaryFolder folder;
    const Image image = test_image();
    write_image(folder / "a.png", image, 0.f, ToneMap::none);
    int width = 0, height = 0;
    const std::vector<std::uint8_t> bytes = read_png(folder / "a.png", width, height);
    ASSERT_EQ(width, 7);
    ASSERT_EQ(height, 5);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        for (int k = 0; k < 3; ++k) EXPECT_EQ(bytes[3 * i + std::size_t(k)], srgb_from_linear(image.pixels[i][k]));
}

TEST(Image, PngIsExposedAndToneMapped) {
    const TemporaryFolder folder;
    const Image image{3, 1, {glm::vec3(0.1f), glm::vec3(1.f), glm::vec3(1e30f, INFINITY, NAN)}};
    int width = 0, height = 0;
    write_image(folder / "a.png", image, 1.f, ToneMap::none);
    EXPECT_EQ(read_png(folder / "a.png", width, height).at(0), srgb_from_linear(0.2f));
    write_image(folder / "a.png", image, 0.f, ToneMap::aces);
    const std::vector<std::uint8_t> bytes = read_png(folder / "a.png", width, height);
    // Narkowicz's curve at 0.1 and at 1, by hand: 0.0281 / 0.2233 and 2.54 / 3.16.
    EXPECT_EQ(bytes.at(0), srgb_from_linear(0.125840f));
    EXPECT_EQ(bytes.at(3), srgb_from_linear(0.803797f));
    EXPECT_EQ(bytes.at(6), 255);
    EXPECT_EQ(bytes.at(7), 255);
    EXPECT_EQ(bytes.at(8), 0) << "NaN";
}

TEST(Image, PngOf16BitsHoldsTheExactSrgbValues) {
    const TemporaryFolder folder;
    const Image image = test_image();
    ImageEncoding encoding;
    encoding.png_bits = 16;
    write_image(folder / "a.png", image, 0.f, ToneMap::none, encoding);
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_us, Freed<stbi_us>> words(
        stbi_load_16((folder / "a.png").c_str(), &width, &height, &channels, 0));
    ASSERT_TRUE(words && width == 7 && height == 5 && channels == 3);
    EXPECT_TRUE(stbi_is_16_bit((folder / "a.png").c_str()));
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double x = std::clamp(double(image.pixels[i][k]), 0.0, 1.0);  // IEC 61966-2-1, written anew
            const double curve = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
            EXPECT_EQ(words.get()[3 * i + std::size_t(k)], std::lround(65535 * curve));
        }
}

/// The largest difference of a byte in two images.
int largest_difference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    int largest = a.size() == b.size() ? 0 : 256;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, std::abs(int(a[i]) - int(b[i])));
    return largest;
}

/// What write_image makes of the pixels as a PNG.
std::vector<std::uint8_t> bytes_of(const Image& image) {
    std::vector<std::uint8_t> bytes;
    for (const glm::vec3& pixel : image.pixels)
        for (int k = 0; k < 3; ++k) bytes.push_back(srgb_from_linear(pixel[k]));
    return bytes;
}

TEST(Image, JpegIsNearWhatItShows) {
    const TemporaryFolder folder;
    const Image image = test_image(40, 23);
    int width = 0, height = 0;
    const auto difference = [&](unsigned quality) {
        ImageEncoding encoding;
        encoding.quality = quality;
        write_image(folder / "a.jpg", image, 0.f, ToneMap::none, encoding);
        const int found = largest_difference(read_png(folder / "a.jpg", width, height), bytes_of(image));
        EXPECT_TRUE(width == 40 && height == 23);
        return found;
    };
    EXPECT_LE(difference(100), 4);
    EXPECT_GT(difference(10), 10);
    // Stripes of a pixel in red and blue of equal luminance are lost where colours have half the pixels.
    Image stripes{32, 32, {}};
    for (unsigned i = 0; i < 32 * 32; ++i) stripes.pixels.push_back(i % 2 ? glm::vec3(0.3f, 0, 0) : glm::vec3(0, 0, 1));
    const auto red_of = [&](unsigned quality) {
        ImageEncoding encoding;
        encoding.quality = quality;
        write_image(folder / "b.jpeg", stripes, 0.f, ToneMap::none, encoding);
        return int(read_png(folder / "b.jpeg", width, height).at(3 * (16 * 32 + 15)));
    };
    EXPECT_NEAR(red_of(91), srgb_from_linear(0.3f), 20);
    EXPECT_LT(red_of(90), srgb_from_linear(0.3f) - 40);
}

#if CLARAY_WITH_WEBP
TEST(Image, WebpIsNearWhatItShowsOrExact) {
    const TemporaryFolder folder;
    Image image{40, 23, {}};  // without edges, also near black, where sRGB is steep
    for (unsigned i = 0; i < 40 * 23; ++i)
        image.pixels.emplace_back(0.3f + float(i % 40) / 80.f, 0.3f + float(i / 40) / 46.f, 0.5f);
    ImageEncoding encoding;
    const auto difference = [&](unsigned quality) {
        encoding.quality = quality;
        write_image(folder / "a.webp", image, 0.f, ToneMap::none, encoding);
        return largest_difference(load_image(folder / "a.webp").bytes, bytes_of(image));
    };
    const int best = difference(100), worst = difference(1);
    EXPECT_TRUE(best > 0 && best < 16 && worst > 2 * best) << best << " " << worst;
    encoding.lossless = true;
    write_image(folder / "a.webp", image, 0.f, ToneMap::none, encoding);
    EXPECT_EQ(load_image(folder / "a.webp").bytes, bytes_of(image));
    expect_error(ErrorKind::usage, {"16384x1", "1 to 16383"}, [&] {
        write_image(folder / "b.webp", Image{16384, 1, std::vector<glm::vec3>(16384)});
    });
}
#else
TEST(Image, WithoutLibwebpAWebpIsRefused) {
    const TemporaryFolder folder;
    expect_error(ErrorKind::usage, {"a.webp", "libwebp"}, [&] { write_image(folder / "a.webp", test_image()); });
}
#endif

TEST(Image, SettingsThatAFormatDoesNotHaveAreRefused) {
    const TemporaryFolder folder;
    const auto refused = [&](const char* name, const ImageEncoding& encoding, const char* words) {
        expect_error(ErrorKind::usage, {name, words}, [&] { check_writable(folder / name, encoding); });
        expect_error(ErrorKind::usage, {name, words},
                     [&] { write_image(folder / name, test_image(), 0.f, ToneMap::aces, encoding); });
    };
    ImageEncoding lossless, bits, quality;
    lossless.lossless = true, bits.png_bits = 12, quality.quality = 101;
    refused("a.jpg", lossless, "a JPEG loses some");
    refused("a.png", bits, "12 bits");
    refused("a.jpg", quality, "quality is 101");
    EXPECT_EQ(folder.entries(), 0u);
    ImageEncoding named;
    named.format = ImageFormat::pfm;
    write_image(folder / "a.anything", test_image(), 0.f, ToneMap::aces, named);
    EXPECT_TRUE(test::read_file(folder / "a.anything").starts_with("PF"));
}

TEST(Image, HdrIsLinearToItsPrecision) {
    const TemporaryFolder folder;
    Image image = test_image(40, 9);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] *= std::exp2(float(i % 60) - 30.f);
    write_image(folder / "a.hdr", image, 3.f, ToneMap::aces);
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<float, Freed<float>> data(
        stbi_loadf((folder / "a.hdr").c_str(), &width, &height, &channels, 3));
    ASSERT_TRUE(data);
    ASSERT_EQ(width, 40);
    ASSERT_EQ(height, 9);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec3& p = image.pixels[i];
        const float precision = std::max({p.x, p.y, p.z}) / 128.f;  // 8 bits of mantissa under the largest's exponent
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(data.get()[3 * i + std::size_t(k)], p[k], precision);
    }
}

TEST(Image, HdrTakesWhatItCannotStore) {
    const TemporaryFolder folder;
    write_image(folder / "a.hdr", Image{2, 1, {glm::vec3(-1.f, NAN, 0.f), glm::vec3(INFINITY, 1e38f, 3.4e38f)}});
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<float, Freed<float>> data(
        stbi_loadf((folder / "a.hdr").c_str(), &width, &height, &channels, 3));
    ASSERT_TRUE(data);
    EXPECT_EQ(data.get()[0], 0.f);
    EXPECT_EQ(data.get()[1], 0.f);
    EXPECT_GT(data.get()[3], 9e37f);
}

/// A reader of PFM after its description only; `scale` is its third line.
std::vector<float> read_pfm(const std::filesystem::path& path, std::string& kind, int& width, int& height,
                            double& scale) {
    std::ifstream file(path, std::ios::binary);
    file >> kind >> width >> height >> scale;
    file.get();
    std::vector<float> values(std::size_t(width * height) * (kind == "PF" ? 3 : 1));
    file.read(reinterpret_cast<char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
    EXPECT_TRUE(file && file.peek() == EOF) << "exactly as long as it says";
    return values;
}

TEST(Image, PfmIsBitExactFromTheBottomUp) {
    const TemporaryFolder folder;
    Image image = test_image();
    image.pixels[3] = {-0.f, INFINITY, 1e-42f};
    write_image(folder / "a.pfm", image, 2.f, ToneMap::aces);
    std::string kind;
    int width = 0, height = 0;
    double scale = 0;
    const std::vector<float> values = read_pfm(folder / "a.pfm", kind, width, height, scale);
    EXPECT_EQ(kind, "PF");
    ASSERT_EQ(width, 7);
    ASSERT_EQ(height, 5);
    EXPECT_EQ(scale, -1.0);
    for (int y = 0; y < height; ++y)
        EXPECT_EQ(std::memcmp(&values[std::size_t(3 * width * (height - 1 - y))], &image.pixels[std::size_t(width * y)],
                              12 * std::size_t(width)),
                  0)
            << "row " << y;
}

TEST(Image, PfmOfOneChannel) {
    const TemporaryFolder folder;
    write_pfm(folder / "a.pfm", 2, 2, {1.f, 2.f, 3.f, INFINITY});
    std::string kind;
    int width = 0, height = 0;
    double scale = 0;
    EXPECT_EQ(read_pfm(folder / "a.pfm", kind, width, height, scale), (std::vector<float>{3.f, INFINITY, 1.f, 2.f}));
    EXPECT_EQ(kind, "Pf");
}

TEST(Image, BadNamesAndSizesAreRefused) {
    const TemporaryFolder folder;
    const Image image = test_image();
    for (const std::string name : {"a.tif", "a", ".png"})
        expect_error(ErrorKind::usage, {name, ".pfm"}, [&] { write_image(folder / name, image); });
    expect_error(ErrorKind::usage, {"a.tif"}, [&] { check_writable(folder / "a.tif"); });
    expect_error(ErrorKind::usage, {"0x5"}, [&] { write_image(folder / "a.png", Image{0, 5, {}}); });
    expect_error(ErrorKind::usage, {"0x0"}, [&] { write_image(folder / "a.pfm", Image{}); });
    expect_error(ErrorKind::usage, {"16385x1"}, [&] {
        write_image(folder / "a.png", Image{16385, 1, std::vector<glm::vec3>(16385)});
    });
    expect_error(ErrorKind::usage, {"35 pixels for 7x4"}, [&] {
        write_image(folder / "a.png", Image{7, 4, image.pixels});
    });
    expect_error(ErrorKind::usage, {"3 pixels for 2x2"}, [&] { write_pfm(folder / "a.pfm", 2, 2, {1.f, 2.f, 3.f}); });
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Image, UpperCaseExtensionsAreTaken) {
    const TemporaryFolder folder;
    write_image(folder / "A.PNG", test_image());
    EXPECT_EQ(test::read_file(folder / "A.PNG").substr(1, 3), "PNG");
}

}  // namespace
}  // namespace claray
