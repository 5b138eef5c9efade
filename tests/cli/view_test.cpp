// `claray view` by scripts.
#include <algorithm>

#include "tests/cli/claray.hpp"
#include "tests/io/gltf/gltf_builder.hpp"

namespace claray::test {
namespace {

class ViewProgram : public InFolder {
protected:
    std::string output_of(const std::string& scene, const std::string& script) {
        const ProcessResult result = run_claray({"view", scene, "--script", folder_.file("script.txt", script).string(),
                                                 "--size", "24x16", "--spp", "2", "-o", path("frames")});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return result.output;
    }
};

TEST_F(ViewProgram, TellsTheTimesOfWhatThereWas) {
    const std::string finish = output_of("cornell", "orbit 1 0\nfinish\n");
    EXPECT_TRUE(finish.starts_with("complete images by finish: 1, median ")) << finish;
    EXPECT_EQ(std::count(finish.begin(), finish.end(), '\n'), 1) << finish;
    const std::string frames = output_of("cornell", "frames 2\norbit 1 0\nframes 1\n");
    EXPECT_TRUE(frames.starts_with("frames: 3, median ")) << frames;
    EXPECT_NE(frames.find("\nanswers of frames to commands: 1, median "), std::string::npos) << frames;
}

TEST_F(ViewProgram, RefusesAnImageThatIsTooLargeToBeLive) {
    const ProcessResult result = run_claray({"view", "cornell", "--size", "8192x8192", "--port", "0"});
    EXPECT_TRUE(failed_with(result, 1, "8192x8192 pixels are too many for a live view; use at most 16.7 million"));
}

TEST_F(ViewProgram, MovesANodeOfAGltf) {
    GltfBuilder builder;
    builder.triangle();
    builder.triangle();
    builder.root["nodes"][0]["name"] = "hero", builder.root["nodes"][1]["name"] = "side";
    builder.root["nodes"][1]["translation"] = {4, 0, 0};
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    builder.push("nodes", {{"camera", 0}, {"translation", {0.3, 0.3, 2}}});
    const std::string scene = folder_.file("scene.gltf", builder.gltf()).string();
    const std::string told = output_of(scene, "pick 12 8\nmove 0 5 0\npick 12 8\ncamera\n");
    EXPECT_TRUE(told.starts_with("object 'hero', mesh 'tri', triangle 0")) << told;
    EXPECT_NE(told.find("\nno surface there\n"), std::string::npos) << told;
    EXPECT_NE(told.find("--look-at 0.300000012,0.300000012,0 "), std::string::npos) << told;
}

}  // namespace
}  // namespace claray::test
