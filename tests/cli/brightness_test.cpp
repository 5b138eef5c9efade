// A picture that shows nothing is told, with what to do.
#include "host/cli/output/brightness.hpp"

#include <fstream>

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
    "the file has no light: added a pale sky as light; choose other light with --light, --sky or --env";

TEST_F(DarkFile, AllCommandsThatRenderLightIt) {
    EXPECT_TRUE(tells(render({}), sky));
    EXPECT_TRUE(tells(
        run({"explain", "--size", "8x8", "--rounds", "1", "--only", "sky", "--no-compile-times", "--quiet"}), sky));
    EXPECT_TRUE(tells(run({"accuracy", "--quick", "--size", "8x8", "--only", "sums", "--runs", "1", "--quiet"}), sky));
    EXPECT_TRUE(tells(run({"bake", "-o", path("a.pfm"), "--size", "4x4", "--spp", "1"}), sky));
}

TEST_F(DarkFile, LightThatIsChosenIsNotDoubted) {
    const ProcessResult black = render({"--sky", "0"});
    EXPECT_FALSE(tells(black, "pale sky"));
    EXPECT_TRUE(tells(black, "the image is black"));
    const ProcessResult dim = render({"--sky", "1e-3"});
    EXPECT_FALSE(tells(dim, "pale sky"));
    EXPECT_TRUE(tells(dim, "brighten it with --exposure"));
    EXPECT_TRUE(tells(render({"--sky", "100"}), "most of the image is white; darken it with --exposure -"));
    EXPECT_EQ(render({"--sky", "1"}).errors, "");
    EXPECT_TRUE(tells(run({"bake", "-o", path("a.pfm"), "--size", "4x4", "--spp", "1", "--sky", "0"}),
                      "the light map is black"));
}

}  // namespace
}  // namespace claray::test
