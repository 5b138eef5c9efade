// claray render: what is chosen of a glTF, and the frames of an animation.
#include <cmath>
#include <fstream>

#include "tests/cli/claray.hpp"
#include "tests/io/gltf/gltf_builder.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

/// A square that shines and goes up by 1 a second, seen by two cameras: "flat" is orthographic.
class GltfOptions : public InFolder {
protected:
    GltfOptions() {
        GltfBuilder builder;
        builder.push("materials", {{"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}});
        builder.triangle({{"material", 0}, {"mode", 5}});
        builder.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
            builder.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
        builder.push("animations",
                     {{"name", "rise"},
                      {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                      {"samplers",
                       {{{"input", builder.accessor<float>("SCALAR", {0, 10})},
                         {"output", builder.accessor<float>("VEC3", {0, 0, 0, 0, 10, 0})}}}}});
        builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
        builder.push("cameras", {{"type", "orthographic"},
                                 {"orthographic", {{"xmag", 2}, {"ymag", 2}, {"zfar", 9}, {"znear", 0.1}}}});
        builder.push("nodes", {{"name", "near"}, {"camera", 0}, {"translation", {0, 0, 4}}});
        builder.push("nodes", {{"name", "flat"}, {"camera", 1}, {"translation", {0, 0, 4}}});
        std::ofstream(path("up.gltf")) << builder.gltf();
    }
    [[nodiscard]] ProcessResult render(const std::string& output, const std::vector<std::string>& more = {}) const {
        return run_claray(with(
            {"render", path("up.gltf"), "-o", path(output), "--size", "16x16", "--spp", "1", "-q", "--sky", "0,0,0"},
            more));
    }
    [[nodiscard]] std::vector<float> pixels_of(const std::string& name) const {
        const std::vector<float> pixels = read_pfm(path(name), 3);
        EXPECT_EQ(pixels.size(), 16u * 16 * 3) << name;
        return pixels;
    }
    /// The height of what shines, in pixels from the bottom.
    [[nodiscard]] double height_in(const std::string& name) const {
        const std::vector<float> pixels = pixels_of(name);
        double sum = 0, weight = 0;
        for (std::size_t i = 0; i < 256; ++i) sum += double(i / 16) * pixels[3 * i], weight += pixels[3 * i];
        return sum / weight;
    }
};

/// Of 16 pixels 4 units high, one is a quarter of a unit.
TEST_F(GltfOptions, TheTimeIsChosen) {
    const ProcessResult at_rest = render("rest.pfm", {"--file-camera", "flat"});
    ASSERT_EQ(at_rest.exit_code, 0) << at_rest.errors;
    EXPECT_NE(at_rest.errors.find("choose a time with --at SECONDS"), std::string::npos) << at_rest.errors;
    const ProcessResult later = render("later.pfm", {"--file-camera", "1", "--at", "0.5", "--animation", "rise"});
    ASSERT_EQ(later.exit_code, 0) << later.errors;
    EXPECT_EQ(later.errors, "");
    EXPECT_NEAR(height_in("later.pfm") - height_in("rest.pfm"), 2, 1e-6);
}

TEST_F(GltfOptions, AFrameIsAPictureOfItsTime) {
    const ProcessResult result =
        render("f.pfm", {"--frames", "1..3", "--frame-rate", "4", "--file-camera", "flat", "--aov", "depth"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const char* name : {"f.0001.pfm", "f.0002.pfm", "f.0003.pfm", "f.0002.depth.pfm", "f.0002.depth.png"})
        EXPECT_TRUE(fs::exists(path(name))) << name;
    for (const char* name : {"f.pfm", "f.0000.pfm", "f.0004.pfm"}) EXPECT_FALSE(fs::exists(path(name))) << name;
    EXPECT_NEAR(height_in("f.0002.pfm") - height_in("f.0001.pfm"), 1, 1e-6);
    EXPECT_NEAR(height_in("f.0003.pfm") - height_in("f.0001.pfm"), 2, 1e-6);
    ASSERT_EQ(render("%02d-up.pfm", {"--frames", "12..12", "--file-camera", "flat"}).exit_code, 0);
    ASSERT_EQ(render("still.pfm", {"--at", "0.5", "--file-camera", "flat"}).exit_code, 0);
    EXPECT_EQ(height_in("12-up.pfm"), height_in("still.pfm")) << "24 frames a second unless told otherwise";
}

/// A box without light stands round the camera at first, where only a lamp helps, and then far away, where a single
/// picture would get a sky.
TEST_F(GltfOptions, AllFramesAreLitAsTheFirst) {
    GltfBuilder builder;
    builder.push("materials", {{"doubleSided", true}});
    builder.triangle({{"material", 0}});
    json& primitive = builder.root["meshes"][0]["primitives"][0];
    std::vector<float> corners;
    for (int i = 0; i < 8; ++i)
        corners.insert(corners.end(), {i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
    primitive["attributes"]["POSITION"] = builder.accessor<float>("VEC3", corners);
    primitive["indices"] = builder.accessor<std::uint8_t>(
        "SCALAR",
        {0, 1, 2, 1, 2, 3, 4, 5, 6, 5, 6, 7, 0, 1, 4, 1, 4, 5, 2, 3, 6, 3, 6, 7, 0, 2, 4, 2, 4, 6, 1, 3, 5, 3, 5, 7});
    builder.push("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                                {"samplers",
                                 {{{"input", builder.accessor<float>("SCALAR", {0, 1})},
                                   {"output", builder.accessor<float>("VEC3", {0, 0, 0, 0, 0, -9})}}}}});
    builder.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
    builder.push("nodes", {{"camera", 0}});
    std::ofstream(path("box.gltf")) << builder.gltf();
    const ProcessResult result = run_claray({"render", path("box.gltf"), "-o", path("b.pfm"), "--size", "16x16",
                                             "--spp", "1", "-q", "--frames", "0..1", "--frame-rate", "1"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find("lamp"), std::string::npos) << result.errors;
    EXPECT_EQ(result.errors.find("studio"), std::string::npos) << result.errors;
    EXPECT_GT(pixels_of("b.0000.pfm")[0], 0.f);
    EXPECT_EQ(pixels_of("b.0001.pfm")[0], 0.f) << "nothing is there";
    EXPECT_GT(pixels_of("b.0001.pfm")[3 * (16 * 8 + 8)], 0.f);
}

/// A sun in lux, before which the triangle turns half away: each frame alone would get another exposure.
TEST_F(GltfOptions, AllFramesHaveTheExposureOfTheFirst) {
    GltfBuilder builder;
    builder.push("materials", {{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
    builder.triangle({{"material", 0}});
    builder.push("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}}},
                                {"samplers",
                                 {{{"input", builder.accessor<float>("SCALAR", {0, 1})},
                                   {"output", builder.accessor<float>("VEC4", {0, 0, 0, 1, 0, 0.6f, 0, 0.8f})}}}}});
    builder.root["extensionsUsed"] = {"KHR_lights_punctual"};
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 2000}}};
    builder.push("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    std::ofstream(path("sun.gltf")) << builder.gltf();
    const auto rendered = [&](const std::string& output, const std::string& frames, const std::string& exposure) {
        std::vector<std::string> words = {
            "render",   path("sun.gltf"), "-o",           path(output), "--size",   "16x16", "--spp",     "4",    "-q",
            "--frames", frames,           "--frame-rate", "1",          "--camera", "0,0,4", "--look-at", "0,0,0"};
        if (!exposure.empty()) words.insert(words.end(), {"--exposure", exposure});
        const ProcessResult result = run_claray(words);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return result.errors;
    };
    const std::string told = rendered("both.png", "0..1", "");
    const std::size_t at = told.find("their exposure is "), stops = at + 18;
    ASSERT_NE(at, std::string::npos) << told;
    EXPECT_EQ(told.find("their exposure is ", stops), std::string::npos) << told;
    static_cast<void>(rendered("given.png", "0..1", told.substr(stops, told.find(' ', stops) - stops)));
    static_cast<void>(rendered("alone.png", "1..1", ""));
    EXPECT_EQ(read_file(path("both.0000.png")), read_file(path("given.0000.png")));
    EXPECT_EQ(read_file(path("both.0001.png")), read_file(path("given.0001.png")));
    EXPECT_NE(read_file(path("both.0001.png")), read_file(path("alone.0001.png")));
}

/// What is given wins over the file's camera: its field of view, its up, its kind of projection.
TEST_F(GltfOptions, TheCommandLineWinsOverTheFilesCamera) {
    const auto same = [&](const std::vector<std::string>& a, const std::vector<std::string>& b) {
        EXPECT_EQ(render("a.pfm", a).exit_code, 0);
        EXPECT_EQ(render("b.pfm", b).exit_code, 0);
        return height_in("a.pfm") == height_in("b.pfm");
    };
    EXPECT_TRUE(same({"--file-camera", "near", "--ortho", "4"}, {"--file-camera", "flat"}));
    EXPECT_TRUE(same({"--file-camera", "flat", "--fov", "30"}, {"--file-camera", "near", "--fov", "30"}));
    EXPECT_FALSE(same({"--file-camera", "near", "--fov", "30"}, {"--file-camera", "near"}));
    EXPECT_FALSE(same({"--up", "0,-1,0"}, {}));
    const std::string help = run_claray({"render", "--help-all"}).output;
    EXPECT_NE(help.find("else 0,1,0]"), std::string::npos);
    EXPECT_NE(help.find("else 40;"), std::string::npos);
}

TEST_F(GltfOptions, BadChoicesAreUsageErrors) {
    const auto refused = [&](const std::vector<std::string>& options, const std::string& words) {
        return failed_with(render("a.png", options), 2, words);
    };
    EXPECT_TRUE(refused({"--at", "-1"}, "--at: '-1' is not a number of 0 or more"));
    EXPECT_TRUE(refused({"--at", "soon"}, "--at: 'soon'"));
    EXPECT_TRUE(refused({"--animation", "rise"}, "without a time"));
    EXPECT_TRUE(refused({"--at", "0", "--animation", "fall"}, "has no animation 'fall'; choose one of 'rise'"));
    EXPECT_TRUE(refused({"--variant", "red"}, "has no variant"));
    EXPECT_TRUE(refused({"--file-camera", "far"}, "has no camera 'far'; choose one of 'near', 'flat'"));
    EXPECT_TRUE(refused({"--file-scene", "3"}, "has no scene"));
    EXPECT_TRUE(refused({"--ortho", "0"}, "--ortho: '0' is not a number of more than 0"));
    EXPECT_TRUE(refused({"--ortho", "2", "--fov", "30"}, "--fov and --ortho contradict"));
    for (const char* range : {"5", "3..1", "a..b", "1..", "..2", "-1..2", "0..1000000", "0...2"})
        EXPECT_TRUE(refused({"--frames", range}, "is not a range of frames")) << range;
    EXPECT_TRUE(refused({"--frames", "0..1", "--frame-rate", "0"}, "--frame-rate: '0'"));
    EXPECT_TRUE(refused({"--frame-rate", "30"}, "--frame-rate has no effect without --frames"));
    EXPECT_TRUE(refused({"--frames", "0..1", "--at", "1"}, "--frames and --at contradict"));
    EXPECT_TRUE(refused({"--frames", "0..1", "--checkpoint", path("c")}, "--frames and --checkpoint contradict"));
    EXPECT_TRUE(refused({"--fps", "5", "--frames", "0..1"}, "'0..1' is not a whole number"));
    for (const char* name : {"%s.png", "%d%d.png", "%4d.png", "%00d.png", "a%.png"})
        EXPECT_TRUE(
            failed_with(render(name, {"--frames", "0..1"}), 2, "has an invalid placeholder for the frame number"))
            << name;
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", path("a.png"), "--at", "1"}), 2,
                            "'cornell' has no animations"));
    EXPECT_TRUE(failed_with(run_claray({"render", path("nowhere.obj"), "-o", path("%d.png"), "--frames", "0..1"}), 1,
                            "nowhere.obj"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace claray::test
