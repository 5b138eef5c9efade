// OpenEXR out and in, if claray was built with it.
#include <gtest/gtest.h>

#include <cmath>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

#if CLARAY_WITH_EXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfEnvmap.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#endif

namespace claray {
namespace {

using test::expect_error;
using test::TemporaryFolder;

#if CLARAY_WITH_EXR

Image exr_image() {
    Image image{5, 3, {}};
    for (int i = 0; i < 15; ++i) image.pixels.emplace_back(float(i), -1e-6f * float(i), 1e6f + float(i));
    image.pixels[7] = glm::vec3(INFINITY, 0.f, 3e38f);
    return image;
}

TEST(Exr, KeepsEveryBit) {
    const TemporaryFolder folder;
    const Image image = exr_image();
    write_image(folder / "a.exr", image, 3.f);  // the exposure is for pictures
    const Texture read = load_image(folder / "a.exr");
    ASSERT_EQ(read.width, 5u);
    ASSERT_EQ(read.height, 3u);
    ASSERT_EQ(read.channels, 3u);
    EXPECT_EQ(read.format, TexelFormat::float32);
    for (std::size_t i = 0; i < 15; ++i)
        for (int k = 0; k < 3; ++k) EXPECT_EQ(read.floats[3 * i + std::size_t(k)], image.pixels[i][k]);
}

TEST(Exr, LayersHaveTheirNamesAndTypes) {
    const TemporaryFolder folder;
    std::vector<ImageLayer> layers = {{"", "RGB", std::vector<float>(12, 0.5f)},
                                      {"depth", "Z", {1, 2, 3, INFINITY}},
                                      {"primitive", "X", {}, {0, 16777217, 7, 0xffffffffu}}};
    write_exr(folder / "a.exr", 2, 2, layers);
    Imf::InputFile file((folder / "a.exr").c_str());
    std::vector<std::string> names;
    for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c)
        names.emplace_back(c.name());
    EXPECT_EQ(names, (std::vector<std::string>{"B", "G", "R", "depth.Z", "primitive.X"}));
    EXPECT_EQ(file.header().channels()["primitive.X"].type, Imf::UINT);
    std::uint32_t numbers[4] = {};
    float depths[4] = {};
    Imf::FrameBuffer buffer;
    buffer.insert("primitive.X", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(numbers), 4, 8));
    buffer.insert("depth.Z", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depths), 4, 8));
    file.setFrameBuffer(buffer);
    file.readPixels(0, 1);
    EXPECT_EQ(numbers[1], 16777217u);
    EXPECT_EQ(numbers[3], 0xffffffffu);
    EXPECT_EQ(depths[2], 3.f);
    EXPECT_EQ(load_image(folder / "a.exr").floats[4], 0.5f);
}

/// Half floats in a layer, as Blender writes them, with a window that does not begin at 0.
TEST(Exr, ReadsTheFirstLayerWithColours) {
    const TemporaryFolder folder;
    Imf::Header header(Imath::Box2i({0, 0}, {9, 9}), Imath::Box2i({2, 3}, {3, 3}));
    const char* names[] = {"View.Combined.R", "View.Combined.G", "View.Combined.B", "View.Combined.A"};
    std::vector<half> values = {1, 2, 3, 4, 5, 6, 7, 8};
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < 4; ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::HALF));
        buffer.insert(names[c], Imf::Slice::Make(Imf::HALF, values.data() + c, header.dataWindow(), 4 * sizeof(half),
                                                 8 * sizeof(half)));
    }
    {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(1);
    }
    const Texture read = load_image(folder / "a.exr");
    ASSERT_EQ(read.width, 10u);
    ASSERT_EQ(read.height, 10u);
    std::vector<float> expected(400, 0.f);
    for (std::size_t i = 0; i < 8; ++i) expected[4 * (3 * 10 + 2) + i] = float(i + 1);
    EXPECT_EQ(read.floats, expected) << "black beyond what is stored";
}

void write_rgba(const std::filesystem::path& path, const Imf::Header& header, Imf::RgbaChannels channels,
                const std::vector<Imf::Rgba>& pixels) {
    const Imath::Box2i& window = header.dataWindow();
    const std::ptrdiff_t width = window.max.x - window.min.x + 1;
    Imf::RgbaOutputFile file(path.c_str(), header, channels);
    file.setFrameBuffer(pixels.data() - (window.min.x + window.min.y * width), 1, std::size_t(width));
    file.writePixels(window.max.y - window.min.y + 1);
}

/// What is stored beyond the image is cut off.
TEST(Exr, ShowsItsDisplayWindow) {
    const TemporaryFolder folder;
    const Imf::Header header(Imath::Box2i({0, 0}, {1, 0}), Imath::Box2i({-1, -1}, {1, 1}));
    std::vector<Imf::Rgba> pixels;
    for (int i = 0; i < 9; ++i) pixels.emplace_back(float(i), 0.f, 0.f);
    write_rgba(folder / "a.exr", header, Imf::WRITE_RGB, pixels);
    const Texture read = load_image(folder / "a.exr");
    EXPECT_EQ(read.width, 2u);
    EXPECT_EQ(read.height, 1u);
    EXPECT_EQ(read.floats, (std::vector<float>{4, 0, 0, 5, 0, 0}));
}

TEST(Exr, ReadsLuminanceAndChroma) {
    const TemporaryFolder folder;
    const Imf::Header header(64, 64);
    write_rgba(folder / "a.exr", header, Imf::WRITE_YCA, std::vector<Imf::Rgba>(64 * 64, {0.8f, 0.4f, 0.1f, 0.5f}));
    const Texture read = load_image(folder / "a.exr");
    ASSERT_EQ(read.channels, 4u);
    for (std::size_t i = 0; i < read.floats.size(); ++i)
        EXPECT_NEAR(read.floats[i], (std::vector<float>{0.8f, 0.4f, 0.1f, 0.5f}[i % 4]), 0.01f) << i;
    write_rgba(folder / "grey.exr", header, Imf::WRITE_YA, std::vector<Imf::Rgba>(64 * 64, {0.5f, 0.5f, 0.5f, 0.25f}));
    const Texture grey = load_image(folder / "grey.exr");
    ASSERT_EQ(grey.channels, 2u);
    EXPECT_NEAR(grey.floats[0], 0.5f, 1e-3f);
    EXPECT_EQ(grey.floats[1], 0.25f);
}

/// Chroma of as many pixels as luminance, in full precision: R and B are (chroma + 1) Y.
TEST(Exr, ReadsChromaOfAllPixels) {
    const TemporaryFolder folder;
    Imf::Header header(3, 1);
    std::vector<float> values = {0.5f, 1, -0.5f, 1, 0, 0, 2, -1, 1};  // Y RY BY
    Imf::FrameBuffer buffer;
    const char* names[] = {"Y", "RY", "BY"};
    for (std::size_t c = 0; c < 3; ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + c, header.dataWindow(), 12, 36));
    }
    {
        Imf::OutputFile file((folder / "a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(1);
    }
    const Texture read = load_image(folder / "a.exr");
    ASSERT_EQ(read.channels, 3u);
    const double r = 0.2126, g = 0.7152, b = 0.0722;
    const std::vector<double> expected = {1, (0.5 - r - 0.25 * b) / g, 0.25, 1, 1, 1, 0, (2 - 4 * b) / g, 4};
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(read.floats[i], expected[i], 1e-3) << i;
}

/// ACEScg, whose white is warmer. The middle column is that of ACES' published matrix to Rec. 709 (1.70505 -0.62179
/// -0.08326, -0.13026 1.14080 -0.01055, -0.02400 -0.12897 1.15297).
TEST(Exr, ConvertsPrimaries) {
    const TemporaryFolder folder;
    Imf::Header header(3, 1);
    Imf::addChromaticities(header, {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}});
    const std::vector<Imf::Rgba> pixels = {{1.f, 1.f, 1.f}, {0.5f, 0.25f, 0.25f}, {0.f, 1.f, 0.f}};
    write_rgba(folder / "a.exr", header, Imf::WRITE_RGB, pixels);
    const Texture read = load_image(folder / "a.exr");
    const std::vector<float> expected = {1,         1,         1,  //
                                         0.676263f, 0.217436f, 0.243999f, 0, 1.140805f, 0};
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(read.floats[i], expected[i], 2e-3f) << i;
}

/// Faces as OpenEXR orients them: red in the direction in which a latitude-longitude image has its middle.
TEST(Exr, CubesAreEnvironments) {
    const TemporaryFolder folder;
    constexpr int side = 8;
    Imf::Header header(side, 6 * side);
    Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
    std::vector<Imf::Rgba> pixels(6 * side * side);
    const auto latitude_longitude = [](const Imath::V3f& d) { return Imath::V2f(d.y, std::atan2(d.x, d.z)); };
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const Imath::V2f in_face{float(x), float(y)};
                const auto which = Imf::CubeMapFace(face);
                const Imath::V3f d = Imf::CubeMap::direction(which, header.dataWindow(), in_face).normalized();
                const Imath::V2f at = Imf::CubeMap::pixelPosition(which, header.dataWindow(), in_face);
                const Imath::V2f angles = latitude_longitude(d);
                pixels[std::size_t(at.y + 0.5f) * side + std::size_t(at.x + 0.5f)] = {1 + angles.x, 4 + angles.y, 0.f};
            }
    write_rgba(folder / "a.exr", header, Imf::WRITE_RGB, pixels);
    const Environment cube = load_environment(folder / "a.exr");
    ASSERT_EQ(cube.images.size(), 6u);
    // The middles of -z, which is the middle of a latitude-longitude image here, of +x at its right, and of +y.
    const auto middle = [&](std::size_t face, std::size_t channel) {
        const Texture& t = cube.images[face];
        float sum = 0;
        for (const unsigned y : {3u, 4u})
            for (const unsigned x : {3u, 4u}) sum += t.floats[3 * (y * side + x) + channel] / 4;
        return sum;
    };
    EXPECT_NEAR(middle(5, 1), 4, 0.01) << "longitude 0";
    EXPECT_NEAR(middle(5, 0), 1, 0.01);
    EXPECT_NEAR(middle(0, 1), 4 - 1.5708, 0.01) << "longitudes fall to the right";
    EXPECT_NEAR(middle(2, 0), 2, 0.02);
    EXPECT_GT(cube.images[5].floats[0], cube.images[5].floats[3 * 7 * side]) << "the top of a face is up";
    header = Imf::Header(side, 5 * side);
    Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
    pixels.resize(5 * side * side);
    write_rgba(folder / "five.exr", header, Imf::WRITE_RGB, pixels);
    expect_error(ErrorKind::user, {"five.exr", "squares"}, [&] { (void)load_environment(folder / "five.exr"); });
}

TEST(Exr, DamagedFilesAreRefused) {
    const TemporaryFolder folder;
    write_image(folder / "a.exr", exr_image());
    const std::string good = test::read_file(folder / "a.exr");
    for (const std::size_t size : {std::size_t(4), std::size_t(40), good.size() / 2, good.size() - 1})
        expect_error(ErrorKind::user, {"bad.exr"},
                     [&] { (void)load_image(folder.file("bad.exr", good.substr(0, size))); });
    write_exr(folder / "two.exr", 1, 1, {{"depth", "ZW", {1, 2}}});
    expect_error(ErrorKind::user, {"two.exr", "channels depth.W, depth.Z", "neither"},
                 [&] { (void)load_image(folder / "two.exr"); });
    write_exr(folder / "depth.exr", 1, 1, {{"depth", "Z", {7}}});
    EXPECT_EQ(load_image(folder / "depth.exr").floats, std::vector<float>{7}) << "the only channel";
    expect_error(ErrorKind::usage, {"2x2"}, [&] { write_exr(folder / "b.exr", 2, 2, {{"depth", "Z", {1}}}); });
}

#else

TEST(Exr, IsRefusedByTheNameOfThePackage) {
    const TemporaryFolder folder;
    expect_error(ErrorKind::usage, {"libopenexr-dev"}, [&] { write_image(folder / "a.exr", {1, 1, {glm::vec3(1)}}); });
}

#endif

}  // namespace
}  // namespace claray
