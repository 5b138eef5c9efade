// Image files in: against files from other encoders and files written by hand here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "claray/io.hpp"
#include "host/io/image/image_file.hpp"
#include "host/io/scene_textures.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/base64.hpp"
#include "tests/io/image/broken_bytes.hpp"
#include "tests/io/image/encoded_images.hpp"
#include "tests/support/process.hpp"

#if CLARAY_WITH_WEBP
#include <webp/encode.h>
#endif

namespace claray {
namespace {

using test::expect_error;
using test::from_base64;
using test::TemporaryFolder;
using Bytes = std::vector<std::uint8_t>;

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

/// An uncompressed true-colour TGA of 2x1, from the bottom up as TGA is: blue, green, red.
std::string tga() { return text_of({0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 0, 24, 0, 3, 2, 1, 6, 5, 4}); }

/// A BMP of 24 bits, 1x2, rows from the bottom up and filled to four bytes.
std::string bmp() {
    Bytes bytes = {'B', 'M', 62, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1, 0, 24, 0};
    bytes.resize(54, 0);
    for (const std::uint8_t byte : {6, 5, 4, 0, 3, 2, 1, 0}) bytes.push_back(byte);
    return text_of(bytes);
}

/// Radiance RGBE, not run-length coded: value = mantissa / 256 * 2^(exponent - 128).
std::string hdr() {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + text_of({128, 64, 32, 129, 0, 0, 0, 0});
}

/// The same run-length coded, which images of 8 pixels and more a row are: a row of equal pixels, then one of different
/// ones, whose exponents are two runs with one of no length between them.
std::string hdr_of_runs() {
    Bytes bytes = {2, 2, 0, 8, 136, 128, 136, 64, 136, 32, 136, 129, 2, 2, 0, 8};
    for (int channel = 0; channel < 3; ++channel) {
        bytes.push_back(8);
        for (int x = 0; x < 8; ++x) bytes.push_back(std::uint8_t(128 + x));
    }
    for (const std::uint8_t byte : {130, 129, 0, 134, 128}) bytes.push_back(byte);
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nSOFTWARE=test\n\n-Y 2 +X 8\n" + text_of(bytes);
}

std::string pfm(const char* header, const std::vector<float>& values) {
    std::string bytes = header;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    return bytes;
}

class LoadImage : public ::testing::Test {
protected:
    Texture load(const std::string& bytes, TexelFormat format = TexelFormat::srgb8) {
        return load_image(folder.file("image.any", bytes), format);
    }
    void refuse(const std::string& bytes, std::initializer_list<std::string> words) {
        expect_error(ErrorKind::user, words, [&] { static_cast<void>(load(bytes)); });
    }
    TemporaryFolder folder;
};

TEST_F(LoadImage, PngKeepsItsChannels) {
    const Texture rgba = load(from_base64(test::png_rgba));
    EXPECT_EQ(rgba.name, "image.any");
    EXPECT_EQ(rgba.width, 2u);
    EXPECT_EQ(rgba.height, 2u);
    EXPECT_EQ(rgba.channels, 4u);
    EXPECT_EQ(rgba.format, TexelFormat::srgb8);
    EXPECT_EQ(rgba.bytes, (Bytes{255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 10, 20, 30, 40}));
    EXPECT_EQ(load(from_base64(test::png_rgba), TexelFormat::linear8).format, TexelFormat::linear8);
    EXPECT_EQ(load(from_base64(test::png_palette)).bytes, (Bytes{200, 100, 50, 255, 9, 8, 7, 77}));
    EXPECT_EQ(load(from_base64(test::png_key)).bytes, (Bytes{1, 2, 3, 0, 4, 5, 6, 255})) << "a transparent colour";
}

TEST_F(LoadImage, SixteenBitsBecomeFloats) {
    const Texture linear = load(from_base64(test::png_grey16), TexelFormat::linear8);
    EXPECT_EQ(linear.format, TexelFormat::float32);
    ASSERT_EQ(linear.floats.size(), 2u);
    EXPECT_EQ(linear.floats[0], 0.f);
    EXPECT_FLOAT_EQ(linear.floats[1], 32769.f / 65535.f);
    const Texture srgb = load(from_base64(test::png_grey16));
    EXPECT_NEAR(srgb.floats.at(1), std::pow((32769.0 / 65535.0 + 0.055) / 1.055, 2.4), 1e-6);
    EXPECT_TRUE(srgb.bytes.empty());
}

TEST_F(LoadImage, Jpeg) {
    const Texture image = load(from_base64(test::jpeg));
    EXPECT_EQ(image.width, 8u);
    EXPECT_EQ(image.channels, 3u);
    ASSERT_EQ(image.bytes.size(), 192u);
    for (std::size_t i = 0; i < 192; ++i) EXPECT_NEAR(image.bytes[i], (Bytes{200, 100, 50}[i % 3]), 4);
}

TEST_F(LoadImage, TgaAndBmp) {
    EXPECT_EQ(load(tga()).bytes, (Bytes{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(load(tga()).width, 2u);
    EXPECT_EQ(load(bmp()).bytes, (Bytes{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(load(bmp()).height, 2u);
}

TEST_F(LoadImage, Hdr) {
    const Texture image = load(hdr());
    EXPECT_EQ(image.format, TexelFormat::float32);
    EXPECT_EQ(image.channels, 3u);
    EXPECT_EQ(image.floats, (std::vector<float>{1.f, 0.5f, 0.25f, 0.f, 0.f, 0.f}));
}

TEST_F(LoadImage, PfmOfEitherByteOrder) {
    const Texture grey = load(pfm("Pf\n1 2\n-1.0\n", {3.f, -4.f}));
    EXPECT_EQ(grey.channels, 1u);
    EXPECT_EQ(grey.floats, (std::vector<float>{-4.f, 3.f})) << "rows go from the bottom up";
    const Texture color = load(pfm("PF 1 1 -1\n", {1.f, 2.f, 3.f}));
    EXPECT_EQ(color.floats, (std::vector<float>{1.f, 2.f, 3.f}));
    std::string big = pfm("Pf\n1 1\n1.0\n", {3.f});
    std::swap(big[big.size() - 4], big[big.size() - 1]);
    std::swap(big[big.size() - 3], big[big.size() - 2]);
    EXPECT_EQ(load(big).floats, (std::vector<float>{3.f}));
}

TEST_F(LoadImage, ReadsWhatIsWritten) {
    for (unsigned channels = 1; channels <= 4; ++channels) {
        Texture texture;
        texture.width = 5, texture.height = 3, texture.channels = channels;
        for (unsigned i = 0; i < 15 * channels; ++i) texture.bytes.push_back(std::uint8_t(i * 37));
        write_texture(folder / "t.png", texture);
        const Texture again = load_image(folder / "t.png");
        EXPECT_EQ(again.bytes, texture.bytes);
        EXPECT_EQ(again.channels, channels);
    }
    Texture real;
    real.width = 2, real.height = 2, real.channels = 3, real.format = TexelFormat::float32;
    real.floats = {1, 2, 3, 4, 5, 6, 7, 8, 9, 1e30f, -1, 0};
    write_texture(folder / "t.pfm", real);
    EXPECT_EQ(load_image(folder / "t.pfm").floats, real.floats);
    expect_error(ErrorKind::usage, {"t.png"}, [&] { write_texture(folder / "t.png", real); });
    real.floats.pop_back();
    expect_error(ErrorKind::usage, {"t.pfm"}, [&] { write_texture(folder / "t.pfm", real); });
}

#if CLARAY_WITH_WEBP
/// Colours where alpha is 0 are the encoder's to choose.
TEST_F(LoadImage, Webp) {
    const Bytes rgba = {10,  20,  30,  255, 40, 50, 60, 128, 70,  80,  90,  1,
                        100, 110, 120, 2,   0,  0,  1,  3,   255, 254, 253, 4};
    const auto encoded = [](std::size_t length, std::uint8_t* bytes) {
        std::string text(reinterpret_cast<const char*>(bytes), length);
        WebPFree(bytes);
        return text;
    };
    std::uint8_t* out = nullptr;
    std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), 3, 2, 12, &out);
    const std::string lossless = encoded(size, out);
    const Texture texture = load(lossless, TexelFormat::linear8);
    EXPECT_EQ(texture.width, 3u);
    EXPECT_EQ(texture.height, 2u);
    EXPECT_EQ(texture.channels, 4u);
    EXPECT_EQ(texture.format, TexelFormat::linear8);
    EXPECT_EQ(texture.bytes, rgba);
    const Bytes grey(64 * 64 * 3, 90);
    size = WebPEncodeRGB(grey.data(), 64, 64, 192, 75.f, &out);
    const std::string lossy = encoded(size, out);
    const Texture image = load(lossy);
    EXPECT_EQ(image.channels, 3u);
    ASSERT_EQ(image.bytes.size(), grey.size());
    for (const std::uint8_t byte : image.bytes) EXPECT_NEAR(byte, 90, 2);
    for (std::size_t cut = 0; cut < lossless.size(); ++cut) refuse(lossless.substr(0, cut), {"image.any"});
    std::string broken = lossless;
    broken[20] = char(broken[20] ^ 0xff);  // the signature of lossless data
    refuse(broken, {"image.any", "WebP"});
}
#endif

TEST_F(LoadImage, RefusesWhatIsNoImage) {
    expect_error(ErrorKind::user, {"gone.png"}, [&] { static_cast<void>(load_image(folder / "gone.png")); });
    refuse("", {"image.any", "empty"});
    refuse("hello, world", {"image.any", "not a PNG, JPEG"});
    expect_error(ErrorKind::usage, {"srgb8"},
                 [&] { static_cast<void>(load(from_base64(test::png_rgba), TexelFormat::float32)); });
}

TEST_F(LoadImage, RefusesWhatIsCutOff) {
    for (const std::string& whole :
         {from_base64(test::png_rgba), from_base64(test::png_palette), from_base64(test::jpeg), tga(), bmp(), hdr(),
          hdr_of_runs(), pfm("PF\n1 1\n-1\n", {1, 2, 3})}) {
        EXPECT_NO_THROW(static_cast<void>(load(whole)));
        // A BMP's last row is filled up; what is cut from that is not missed.
        const std::size_t filling = whole[0] == 'B' ? 1 : 0;
        for (std::size_t size = 0; size + filling < whole.size(); ++size)
            expect_error(ErrorKind::user, {"image.any"}, [&] { static_cast<void>(load(whole.substr(0, size))); });
    }
}

TEST_F(LoadImage, HdrOfRuns) {
    const Texture image = load(hdr_of_runs());
    ASSERT_EQ(image.width, 8u);
    ASSERT_EQ(image.height, 2u);
    EXPECT_EQ(image.floats[3 * 7], 1.f);
    EXPECT_EQ(image.floats[3 * 7 + 2], 0.25f);
    EXPECT_EQ(image.floats[3 * (8 + 1)], 129 / 128.f);
    EXPECT_EQ(image.floats[3 * (8 + 2)], 130 / 256.f);
    for (const std::size_t at : {hdr_of_runs().size() - 1, hdr_of_runs().size() - 3})
        refuse(hdr_of_runs().substr(0, at), {"image.any", "cut off"});
    std::string long_run = hdr_of_runs();
    long_run[long_run.find("+X 8\n") + 9] = char(137);
    refuse(long_run, {"image.any", "runs are longer than its rows"});
}

TEST_F(LoadImage, PngsChecksumsAreChecked) {
    const std::string whole = from_base64(test::png_rgba);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string broken = whole;
        broken[i] = char(broken[i] ^ 4);
        refuse(broken, {"image.any"});
    }
}

/// Every table of the file, one after the other, gets a count too many.
TEST_F(LoadImage, JpegsHuffmanTablesAreBounded) {
    const std::string whole = from_base64(test::jpeg);
    std::size_t tables = 0;
    for (std::size_t at = whole.find("\xff\xc4"); at != std::string::npos; at = whole.find("\xff\xc4", at + 1)) {
        std::string broken = whole;
        broken[at + 6] = broken[at + 7] = char(0xff);
        refuse(broken, {"image.any", "Huffman"});
        ++tables;
    }
    EXPECT_GT(tables, 0u);
}

TEST_F(LoadImage, DamagedJpegsHaveAReason) {
    const std::string whole = from_base64(test::jpeg);
    std::string broken = whole;
    broken[whole.find("\xff\xda") + 5] = 99;  // a component that does not exist
    refuse(broken, {"image.any", "component"});
    broken = whole;
    broken[whole.find("\xff\xc0") + 4] = 12;  // bits
    refuse(broken, {"image.any", "precision 12"});
    broken[whole.find("\xff\xc0") + 1] = char(0xc3);  // lossless
    refuse(broken, {"image.any", "SOF type 0xc3"});
}

/// Bytes between segments, and data that end before their image.
TEST_F(LoadImage, JpegsOfOtherProgramsAreRead) {
    const std::string whole = from_base64(test::jpeg);
    const Bytes plain = load(whole).bytes;
    std::string odd = whole;
    odd.insert(odd.find("\xff\xc0"), "junk\xff\xff");
    EXPECT_EQ(load(odd).bytes, plain) << "bytes between segments";
    odd = whole;
    odd.insert(2, text_of({0xff, 0xfe, 0, 4, 'h', 'i'}));
    EXPECT_EQ(load(odd).bytes, plain) << "a comment";
    odd = whole;
    odd.erase(odd.size() - 6, 4);
    EXPECT_EQ(load(odd).bytes.size(), plain.size()) << "a marker before the last pixels";
}

TEST_F(LoadImage, BrokenBytesNeverCrash) {
    for (const std::string& whole : {from_base64(test::png_palette), from_base64(test::jpeg), tga(), bmp(), hdr(),
                                     hdr_of_runs(), pfm("PF\n1 1\n-1\n", {1, 2, 3})})
        test::expect_whole_or_one_line(whole, 500);
}

TEST_F(LoadImage, RefusesMoreThanTheLimit) {
    std::string wide = tga();
    wide[13] = 0x41;  // 16642 pixels wide
    refuse(wide, {"image.any", "16642x1", "16384"});
    refuse("Pf\n16385 1\n-1\n", {"16385x1", "16384"});
    refuse("PF\n16384 16384\n-1\n", {"3221225472 bytes", "1073741824"});
    std::string hollow = tga();  // 12.5 million pixels of 6 bytes
    hollow[13] = 0x30, hollow[15] = 0x10;
    refuse(hollow, {"cut off"});
}

TEST_F(LoadImage, EnvironmentIsAnImageOrSix) {
    const Environment one = load_environment(folder.file("sky.hdr", hdr()));
    ASSERT_EQ(one.images.size(), 1u);
    EXPECT_EQ(one.images[0].width, 2u);
    std::filesystem::create_directory(folder / "cube");
    for (const char* face : {"px", "nx", "py", "ny", "pz"})
        static_cast<void>(folder.file("cube/" + std::string(face) + ".tga", tga()));
    expect_error(ErrorKind::user, {"cube", "'nz'"}, [&] { static_cast<void>(load_environment(folder / "cube")); });
    static_cast<void>(folder.file("cube/nz.png", from_base64(test::png_rgba)));
    const Environment six = load_environment(folder / "cube");
    ASSERT_EQ(six.images.size(), 6u);
    EXPECT_EQ(six.images[0].name, "px.tga");
    EXPECT_EQ(six.images[5].name, "nz.png");
    expect_error(ErrorKind::user, {"gone"}, [&] { static_cast<void>(load_environment(folder / "gone")); });
}

TEST(PathInScene, RefusesWhatLeavesTheFolder) {
    const TemporaryFolder folder;
    const std::filesystem::path root = folder / "scene";
    std::filesystem::create_directories(root / "sub");
    static_cast<void>(folder.file("secret.png", ""));
    static_cast<void>(folder.file("scene/a.png", ""));
    std::filesystem::create_symlink("../secret.png", root / "out.png");
    std::filesystem::create_symlink("a.png", root / "in.png");
    std::filesystem::create_directory_symlink("..", root / "up");
    const auto refuse = [&](const std::string& name, const char* why) {
        expect_error(ErrorKind::user, {why}, [&] { static_cast<void>(path_in_scene(root, root, name)); });
    };
    for (const char* name : {"../secret.png", "sub/../../secret.png", "..\\secret.png", "out.png", "up/secret.png",
                             "sub/../../scene2/x.png", "../gone.png"})
        refuse(name, "leaves the scene's folder");
    for (const char* name : {"/etc/passwd", "\\\\server\\x.png"}) refuse(name, "absolute");
    for (const char* name : {"http://x.org/a.png", "file:///etc/passwd", "C:\\a.png", "c:a.png"}) refuse(name, "URL");
    refuse("", "empty");
    refuse(std::string("a\0b", 3), "zero");
    refuse(std::string(5000, 'a'), "resolved");
    for (const char* name : {"a.png", "in.png", "sub/../a.png", "sub\\..\\a.png", "./a.png"})
        EXPECT_TRUE(std::filesystem::equivalent(path_in_scene(root, root, name), root / "a.png")) << name;
    EXPECT_EQ(path_in_scene(root, root / "sub", "../a.png"), root / "sub" / "../a.png") << "relative to a folder below";
    EXPECT_EQ(path_in_scene("", "", "gone/x.png"), std::filesystem::path("./gone/x.png"));
}

TEST(PathInScene, DecodesUris) {
    EXPECT_EQ(percent_decoded("a%20b%2e%2E%2f"), "a b../");
    EXPECT_EQ(percent_decoded("100%"), "100%");
    EXPECT_EQ(percent_decoded("%zz%4"), "%zz%4");
}

}  // namespace
}  // namespace claray
