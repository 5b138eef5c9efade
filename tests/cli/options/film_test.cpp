// claray render --frames to one film, for a pipe to ffmpeg; and an EXR with layers.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "claray/io.hpp"
#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

class Film : public InFolder {
protected:
    /// Frames 0 to 2 of 16 x 12 pixels of an animated scene.
    [[nodiscard]] static ProcessResult render(const std::string& output, const std::vector<std::string>& more = {}) {
        const std::string scene = std::string(CLARAY_SOURCE_DIR) + "/tests/fuzz/corpus/gltf/posed.gltf";
        return run_claray(with({"render", scene, "-o", output, "--size", "16x12", "--spp", "1", "-q"}, more));
    }
    static constexpr std::size_t frame_bytes = 6 + 3 * 16 * 12;
    const std::string header = "YUV4MPEG2 W16 H12 F24:1 Ip A1:1 C444\n";
};

TEST_F(Film, AFileAndAPipeHaveTheSameFrames) {
    const ProcessResult piped = render("-", {"--frames", "0..2"}), filed = render(path("a.y4m"), {"--frames", "0..2"});
    ASSERT_EQ(piped.exit_code, 0) << piped.errors;
    ASSERT_EQ(filed.exit_code, 0) << filed.errors;
    EXPECT_EQ(piped.output.substr(0, header.size()), header);
    EXPECT_EQ(piped.output.size(), header.size() + 3 * frame_bytes) << "nothing but the film";
    EXPECT_EQ(read_file(path("a.y4m")), piped.output);
    EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(Film, APipeTakesImagesOneBehindTheOther) {
    for (const char* format : {"png", "jpg"}) {
        const std::vector<std::string> frames = {"--frames", "0..2", "--format", format};
        const ProcessResult piped = render("-", frames), filed = render(path("a.any"), frames);
        ASSERT_EQ(piped.exit_code, 0) << piped.errors;
        ASSERT_EQ(filed.exit_code, 0) << filed.errors;
        std::string all;
        for (const char* name : {"a.0000.any", "a.0001.any", "a.0002.any"}) all += read_file(path(name));
        EXPECT_TRUE(piped.output == all) << format << ": " << piped.output.size() << " bytes, files " << all.size();
    }
}

TEST_F(Film, TellsOfAllFramesUnlessQuiet) {
    const std::string scene = std::string(CLARAY_SOURCE_DIR) + "/tests/fuzz/corpus/gltf/posed.gltf";
    const ProcessResult result =
        run_claray({"render", scene, "-o", path("a.png"), "--size", "16x12", "--spp", "1", "--frames", "3..5"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find(" %  frame 1/3, "), std::string::npos) << result.errors;
    EXPECT_EQ(render(path("a.png"), {"--frames", "3..5"}).errors.find(" %  frame "), std::string::npos);
}

TEST_F(Film, IsALineOfJsonForEachFrame) {
    const ProcessResult result = render(path("a.pfm"), {"--frames", "1..2", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    std::istringstream lines(result.output);
    unsigned frame = 1;
    for (std::string line; std::getline(lines, line); ++frame)
        EXPECT_EQ(nlohmann::json::parse(line).at("output"), path("a.000" + std::to_string(frame) + ".pfm"));
    EXPECT_EQ(frame, 3u) << result.output;
}

TEST_F(Film, HasNoHeaderWithoutAFrame) {
    const ProcessResult result = run_claray({"render", path("nowhere.gltf"), "-o", "-", "--frames", "0..1", "-q"});
    EXPECT_TRUE(failed_with(result, 1, "nowhere.gltf"));
    EXPECT_EQ(result.output, "");
}

TEST_F(Film, IsRefusedWhereItHasNoPlace) {
    EXPECT_TRUE(failed_with(render(path("a.y4m")), 2, "add --frames"));
    EXPECT_TRUE(failed_with(render("-", {"--format", "y4m"}), 2, "add --frames"));
    EXPECT_TRUE(failed_with(render(path("a.y4m"), {"--frames", "0..1", "--aov", "depth"}), 2, "--aov"));
    EXPECT_TRUE(failed_with(render("-", {"--frames", "0..1", "--aov", "depth", "--format", "exr"}), 2, "--aov"));
    EXPECT_TRUE(failed_with(render("-", {"--frames", "0..1", "--json"}), 2, "--json"));
    EXPECT_EQ(folder_.entries(), 0u);
}

#if CLARAY_WITH_EXR
TEST_F(Film, AovsAreLayersOfAnExr) {
    const ProcessResult result = run_claray(
        {"render", "cornell", "-o", path("a.exr"), "--size", "16x12", "--spp", "1", "-q", "--aov", "depth,primitive"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(folder_.entries(), 1u) << "no files beside it";
    const std::string bytes = read_file(path("a.exr"));
    for (const char* name : {"R", "depth.Z", "primitive.X"})
        EXPECT_NE(bytes.find(std::string(name) + '\0'), bytes.npos) << name;
    const Texture image = load_image(path("a.exr"));
    EXPECT_GT(*std::max_element(image.floats.begin(), image.floats.end()), 0.f);
}

TEST_F(Film, CryptomattesAndLightAreLayersOfAnExr) {
    const std::vector<std::string> quick = {"--size", "16x12", "--spp", "1", "-q"};
    const auto run = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), quick.begin(), quick.end());
        return run_claray(arguments);
    };
    const ProcessResult result = run(
        {"render", "cornell", "-o", path("b.exr"), "--aov", "crypto_object,lobes", "--light-group", "lamp=material:3"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(folder_.entries(), 1u);
    const std::string bytes = read_file(path("b.exr"));
    for (const char* name : {"crypto_object.R", "crypto_object00.A", "cryptomatte/f834d0a/conversion",
                             "lobe_diffuse_direct.R", "lobe_rest.B", "light_lamp.G", "light_rest.G"})
        EXPECT_NE(bytes.find(std::string(name) + '\0'), bytes.npos) << name;
    EXPECT_NE(bytes.find("uint32_to_float32"), bytes.npos);
    EXPECT_TRUE(failed_with(run({"render", "cornell", "-o", path("a.png"), "--aov", "crypto_object"}), 2, "NAME.exr"));
    EXPECT_TRUE(
        failed_with(run({"render", "cornell", "-o", path("a.png"), "--light-group", "a=moon"}), 2, "there are: sky"));
    EXPECT_EQ(folder_.entries(), 1u);
    ASSERT_EQ(run({"render", "cornell", "-o", path("a.png"), "--light-group", "a=sky"}).exit_code, 0);
    EXPECT_EQ(folder_.entries(), 6u) << "a.png, and .png and .pfm of light_a and of light_rest";
}
#endif

}  // namespace
}  // namespace claray::test
