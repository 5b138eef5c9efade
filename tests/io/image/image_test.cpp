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

#include <cmath>
#include <cstring>
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
    for (const std::string name : {"a.jpg", "a", ".png"})
        expect_error(ErrorKind::usage, {name, ".pfm"}, [&] { write_image(folder / name, image); });
    expect_error(ErrorKind::usage, {"a.jpg"}, [&] { check_writable(folder / "a.jpg"); });
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
