// OpenEXR out and in, if claray was built with it.
#include <gtest/gtest.h>

#include <cmath>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

#if CLARAY_WITH_EXR
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
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
    EXPECT_EQ(read.width, 2u);
    EXPECT_EQ(read.height, 1u);
    EXPECT_EQ(read.floats, (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST(Exr, DamagedFilesAreRefused) {
    const TemporaryFolder folder;
    write_image(folder / "a.exr", exr_image());
    const std::string good = test::read_file(folder / "a.exr");
    for (const std::size_t size : {std::size_t(4), std::size_t(40), good.size() / 2, good.size() - 1})
        expect_error(ErrorKind::user, {"bad.exr"},
                     [&] { (void)load_image(folder.file("bad.exr", good.substr(0, size))); });
    write_exr(folder / "depth.exr", 1, 1, {{"depth", "Z", {1}}});
    expect_error(ErrorKind::user, {"depth.exr", "neither"}, [&] { (void)load_image(folder / "depth.exr"); });
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
