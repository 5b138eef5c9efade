// A picture that shows nothing is told, with what to do.
#include "host/cli/output/brightness.hpp"

#include <cmath>
#include <fstream>

#include "claray/io.hpp"

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

std::string warning(const std::vector<glm::vec3>& pixels, std::optional<float> exposure) {
    return cli::brightness_warning(pixels, exposure).value_or("");
}

TEST(Brightness, OfPixels) {
    std::vector<glm::vec3> pixels(1000, glm::vec3(0.f));
    const std::string black = "the image is black: no light reaches the visible surfaces";
    EXPECT_EQ(warning(pixels, 0.f).find(black), 0u);
    EXPECT_EQ(warning(pixels, {}).find(black), 0u) << "files of radiance, too";
    for (int i = 0; i < 20; ++i) pixels[std::size_t(i)] = glm::vec3(0.5f);
    EXPECT_EQ(warning(pixels, 0.f), "") << "stars on black";
    for (int i = 5; i < 20; ++i) pixels[std::size_t(i)] = glm::vec3(0.f);
    EXPECT_NE(warning(pixels, 0.f).find("nearly black"), std::string::npos) << "a few fireflies";
    for (glm::vec3& pixel : pixels) pixel = glm::vec3(1e-3f);
    EXPECT_NE(warning(pixels, 0.f).find("nearly black"), std::string::npos);
    EXPECT_NE(warning(pixels, 0.f).find("--exposure 9"), std::string::npos) << "0.5 is 512 times as much";
    EXPECT_EQ(warning(pixels, {}), "");
    EXPECT_EQ(warning(pixels, 9.f), "");
    for (glm::vec3& pixel : pixels) pixel = glm::vec3(32.f);
    EXPECT_NE(warning(pixels, 0.f).find("--exposure -6"), std::string::npos);
    EXPECT_EQ(warning(pixels, -6.f), "");
    EXPECT_EQ(warning(pixels, {}), "");
    EXPECT_EQ(warning({}, 0.f), "");
}

const char* fault_of(const std::vector<glm::vec3>& pixels, const std::vector<float>& depth = {},
                     ToneMap tone_map = ToneMap::aces) {
    const char* const fault = cli::SurfaceBrightness(pixels, depth, tone_map).fault();
    return fault ? fault : "";
}

TEST(Brightness, OfSurfaces) {
    std::vector<glm::vec3> pixels(1000, glm::vec3(0.f));
    std::vector<float> depth(1000, INFINITY);
    EXPECT_STREQ(fault_of(pixels, depth), "") << "no surface";
    for (int i = 0; i < 100; ++i) pixels[std::size_t(i)] = glm::vec3(256.f), depth[std::size_t(i)] = 1.f;
    EXPECT_STREQ(fault_of(pixels, depth), "white");
    EXPECT_STREQ(fault_of(pixels), "white") << "black pixels are not lit";
    EXPECT_NEAR(cli::SurfaceBrightness(pixels, depth).exposure(), -9, 1e-6);
    for (int i = 100; i < 1000; ++i) pixels[std::size_t(i)] = glm::vec3(1.f);
    EXPECT_STREQ(fault_of(pixels), "") << "the background is not white";
    EXPECT_STREQ(fault_of(pixels, depth), "white");
    for (int i = 0; i < 60; ++i) pixels[std::size_t(i)] = glm::vec3(0.5f);
    EXPECT_STREQ(fault_of(pixels, depth), "") << "most surfaces are visible";
    for (int i = 0; i < 100; ++i) pixels[std::size_t(i)] = glm::vec3(2.f);
    EXPECT_STREQ(fault_of(pixels, depth), "");
    EXPECT_STREQ(fault_of(pixels, depth, ToneMap::none), "white") << "which ends at 1";
    for (int i = 0; i < 95; ++i) pixels[std::size_t(i)] = glm::vec3(1e-3f);
    EXPECT_STREQ(fault_of(pixels, depth), "black");
    for (int i = 0; i < 95; ++i) pixels[std::size_t(i)] = glm::vec3(0.f);
    EXPECT_STREQ(fault_of(pixels, depth), "") << "what is lit is light enough";
}

TEST(Brightness, ADarkSurfaceInLightIsNoFault) {
    const std::vector<glm::vec3> pixels(10, glm::vec3(0.002f)), dark(10, glm::vec3(0.003f)), light(10, glm::vec3(0.5f));
    const std::vector<float> depth(10, 1.f);
    const auto with = [&](const std::vector<glm::vec3>& albedo) {
        return cli::SurfaceBrightness(pixels, depth, ToneMap::aces, albedo);
    };
    EXPECT_STREQ(with(light).fault(), "black");
    EXPECT_EQ(with(dark).fault(), nullptr);
    EXPECT_NEAR(with(dark).exposure(), std::log2(0.5 / 0.12), 0.1) << "as dark grey would be shown";
    const std::vector<glm::vec3> none(10, glm::vec3(0.f));
    EXPECT_EQ(with(none).exposure(), with(light).exposure()) << "what reflects nothing shines itself";
}

/// A square that nothing lights.
class DarkFile : public InFolder {
protected:
    void SetUp() override {
        std::ofstream(path("a.mtl")) << "newmtl a\nKd .5 .5 .5\n";
        std::ofstream(path("a.obj")) << "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    }
    [[nodiscard]] ProcessResult run(std::vector<std::string> arguments,
                                    const std::vector<std::string>& more = {}) const {
        arguments.insert(arguments.begin() + 1, path("a.obj"));
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_claray(arguments);
    }
    [[nodiscard]] ProcessResult render(const std::vector<std::string>& more) const {
        return run({"render", "-o", path("a.png"), "--size", "16x16", "--spp", "4", "--quiet"}, more);
    }
};

bool tells(const ProcessResult& result, const std::string& words) {
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result.errors.find(words) != std::string::npos;
}

constexpr const char* sky =
    "the file has no light: added a neutral studio as light; choose other light with --light, --sky or --env";

TEST_F(DarkFile, AllCommandsThatRenderLightIt) {
    EXPECT_TRUE(tells(render({"--exposure", "0"}), sky));
    EXPECT_TRUE(tells(
        run({"explain", "--size", "8x8", "--rounds", "1", "--only", "sky", "--no-compile-times", "--quiet"}), sky));
    EXPECT_TRUE(tells(run({"accuracy", "--quick", "--size", "8x8", "--only", "sums", "--runs", "1", "--quiet"}), sky));
    EXPECT_TRUE(tells(run({"bake", "-o", path("a.pfm"), "--size", "4x4", "--spp", "1"}), sky));
}

TEST_F(DarkFile, LightThatIsChosenIsNotDoubted) {
    const ProcessResult black = render({"--sky", "0"});
    EXPECT_FALSE(tells(black, "studio"));
    EXPECT_TRUE(tells(black, "the image is black"));
    const ProcessResult dim = render({"--sky", "1e-3"});
    EXPECT_FALSE(tells(dim, "studio"));
    EXPECT_TRUE(tells(dim, "the surfaces would be mostly black: their exposure is +"));
    EXPECT_TRUE(tells(render({"--sky", "1e-3", "--exposure", "0"}), "brighten it with --exposure"));
    EXPECT_TRUE(tells(render({"--sky", "100"}), "the surfaces would be mostly white: their exposure is -"));
    EXPECT_TRUE(
        tells(render({"--sky", "100", "--exposure", "0"}), "most of the image is white; darken it with --exposure -"));
    EXPECT_EQ(render({"--sky", "1"}).errors, "");
    EXPECT_TRUE(tells(run({"bake", "-o", path("a.pfm"), "--size", "4x4", "--spp", "1", "--sky", "0"}),
                      "the light map is black"));
}

/// The byte of green in the middle of a picture.
unsigned middle_of(const std::filesystem::path& png) {
    const Texture image = load_image(png);
    return image.bytes.at(image.channels * (image.width * (image.height / 2) + image.width / 2) + 1);
}

/// White would have the luminance 0.5, so the square, which reflects half, has 0.25.
TEST_F(DarkFile, LightThatIsAddedIsExposed) {
    const std::string line = "added a neutral studio as light, with an exposure of ";
    const ProcessResult exposed = render({"--spp", "256"});
    ASSERT_TRUE(tells(exposed, line)) << exposed.errors;
    const double stops = std::stod(exposed.errors.substr(exposed.errors.find(line) + line.size()));
    EXPECT_NEAR(middle_of(path("a.png")), 165, 8);
    const std::vector<std::uint8_t> chosen = load_image(path("a.png")).bytes;
    EXPECT_FALSE(tells(render({"--spp", "256", "-o", path("a.pfm")}), "exposure")) << "which stores the radiance";
    EXPECT_NEAR(load_image(path("a.pfm")).floats[3 * (16 * 8 + 8)] * std::exp2(stops), 0.25, 0.03);
    EXPECT_FALSE(tells(render({"--spp", "256", "--exposure", std::to_string(stops)}), line));
    EXPECT_EQ(load_image(path("a.png")).bytes, chosen);
    EXPECT_TRUE(tells(render({"--turntable", "2"}), line)) << "of both frames";
}

/// Lamps in candela and suns in lux, as Blender exports them, keep their ratios; only the exposure changes.
TEST_F(DarkFile, LightInPhysicalUnitsIsExposed) {
    const auto lit = [&](const std::string& lux, const std::vector<std::string>& more) {
        std::vector<std::string> options = {"--light", "directional,direction=0,0,-1,intensity=" + lux};
        options.insert(options.end(), more.begin(), more.end());
        return render(options);
    };
    const std::string line = "the surfaces would be mostly white: their exposure is -";
    EXPECT_FALSE(tells(lit("3", {}), "exposure"));
    EXPECT_TRUE(tells(lit("2000", {}), line));
    const unsigned chosen = middle_of(path("a.png"));
    EXPECT_TRUE(chosen > 150 && chosen < 230) << chosen;
    EXPECT_FALSE(tells(lit("2000", {"--exposure", "0"}), line));
    EXPECT_GT(middle_of(path("a.png")), 250u);
    for (const char* name : {"automatic", "auto"}) EXPECT_EQ(lit("3", {"--exposure", name}).errors, "");
    EXPECT_NEAR(middle_of(path("a.png")), chosen, 3);
    EXPECT_FALSE(tells(lit("2000", {"-o", path("a.pfm")}), line)) << "which stores the radiance";
    EXPECT_NEAR(load_image(path("a.pfm")).floats[3 * (16 * 8 + 8)], 2000 * 0.5 / 3.14159265, 1);
    EXPECT_TRUE(tells(lit("3", {"-o", path("a.hdr"), "--exposure", "automatic"}),
                      "apply to .png, .jpg, .webp and videos only"));
    EXPECT_NE(render({"--exposure", "bright"}).errors.find("not a number; write it as in -1.5, or automatic"),
              std::string::npos);
}

/// A cube whose fronts are inside.
TEST_F(DarkFile, OneSidedRoomsAreSeenFromInside) {
    std::ofstream room(path("a.obj"));
    for (int i = 0; i < 8; ++i)
        room << "v " << (i & 1 ? 1 : -1) << (i & 2 ? " 1 " : " -1 ") << (i & 4 ? 1 : -1) << "\n";
    room << "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n";
    room.close();
    const ProcessResult inside = render({"--cull", "back"});
    EXPECT_TRUE(tells(inside, "the view is from inside; choose another with --camera and --look-at; --cull none"));
    EXPECT_GT(middle_of(path("a.png")), 50u);
    const char* const told = "from inside";
    EXPECT_FALSE(tells(render({"--cull", "none"}), told));
    EXPECT_FALSE(tells(render({"--cull", "back", "--camera", "0,0,0", "--look-at", "1,0,0"}), told));
}

TEST_F(DarkFile, TheViewIsExposedToo) {
    std::ofstream(path("script.txt")) << "finish\nexposure 0\n";
    const auto view = [&](const std::string& lux, const std::vector<std::string>& more) {
        std::vector<std::string> options = {"view", "--script", path("script.txt"), "--size", "16x16", "--spp", "4"};
        options.insert(options.end(), {"--light", "directional,direction=0,0,-1,intensity=" + lux});
        return run(options, more);
    };
    const ProcessResult bright = view("2000", {});
    EXPECT_TRUE(tells(bright, "the surfaces would be mostly white: their exposure is -"));
    EXPECT_NE(bright.output.find("exposure -"), std::string::npos) << bright.output;
    EXPECT_FALSE(tells(view("2000", {"--exposure", "0"}), "exposure"));
    EXPECT_FALSE(tells(view("3", {}), "exposure"));
}

TEST_F(DarkFile, OptionsThatChangeNothingAreTold) {
    EXPECT_TRUE(tells(render({"--adaptive"}), "--adaptive changed nothing"));
    EXPECT_TRUE(tells(render({"--guide"}), "--guide changed nothing"));
    EXPECT_FALSE(tells(render({}), "changed nothing"));
    EXPECT_FALSE(tells(render({"--no-guide"}), "changed nothing"));
}

}  // namespace
}  // namespace claray::test
