// claray render: images, auxiliary images, statistics, signals.
#include <cmath>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "claray/scene.hpp"
#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Render : public InFolder {
protected:
    /// Renders 24 x 16 pixels, 2 samples each, unless `more` says otherwise.
    [[nodiscard]] ProcessResult render(const std::string& scene, const std::string& output,
                                       const std::vector<std::string>& more = {}) const {
        return run_claray(with({"render", scene, "-o", path(output), "--size", "24x16", "--spp", "2"}, more));
    }
    [[nodiscard]] std::size_t file_count() const {
        return std::size_t(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
    }
};

/// The bowl of the scene has no back sides: its content is seen through its wall.
TEST_F(Render, SidesOfSurfacesCanBeChosen) {
    const auto primitives = [&](const std::vector<std::string>& options) {
        std::vector<std::string> all = {"--aov", "primitive"};
        all.insert(all.end(), options.begin(), options.end());
        const ProcessResult result = render("effect:culling", "a.pfm", all);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return read_pfm(path("a.primitive.pfm"), 1);
    };
    const std::vector<float> by_file = primitives({}), both = primitives({"--cull", "none"});
    EXPECT_NE(by_file, both);
    EXPECT_EQ(primitives({"--cull", "file", "--front", "ccw"}), by_file);
    EXPECT_NE(primitives({"--front", "cw"}), by_file);
    EXPECT_EQ(primitives({"--cull", "none", "--front", "cw"}), both);
}

TEST_F(Render, EveryBuiltInScene) {
    for (std::string name : builtin_scene_names()) {
        if (name.ends_with(":N")) name.replace(name.size() - 1, 1, "500");
        if (name.ends_with(":NAME")) name = "effect:mirror";
        const ProcessResult result = render(name, "image.pfm");
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_NE(result.output.find("image.pfm: 24x16, 2 spp"), std::string::npos) << result.output;
        const std::vector<float> pixels = read_pfm(path("image.pfm"), 3);
        ASSERT_EQ(pixels.size(), 24u * 16 * 3) << name;
        double sum = 0;
        for (const float value : pixels) sum += value;
        EXPECT_TRUE(std::isfinite(sum) && sum > 0) << name << " is black or worse: " << sum;
    }
}

TEST_F(Render, EveryFormatHasItsSignature) {
    for (const auto& [name, signature] :
         {std::pair("a.png", "\x89PNG"), {"a.jpg", "\xff\xd8"}, {"a.hdr", "#?RADIANCE"}, {"a.pfm", "PF\n24 16\n"}}) {
        ASSERT_EQ(render("cornell", name).exit_code, 0);
        EXPECT_TRUE(read_file(path(name)).starts_with(signature)) << name;
    }
}

TEST_F(Render, SameSeedSameImageOtherSeedOtherImage) {
    ASSERT_EQ(render("cornell", "a.pfm", {"--seed", "7"}).exit_code, 0);
    ASSERT_EQ(render("cornell", "b.pfm", {"--seed", "7"}).exit_code, 0);
    ASSERT_EQ(render("cornell", "c.pfm", {"--seed", "8"}).exit_code, 0);
    EXPECT_EQ(read_file(path("a.pfm")), read_file(path("b.pfm")));
    EXPECT_NE(read_file(path("a.pfm")), read_file(path("c.pfm")));
}

TEST_F(Render, DenoisesByTheNamedDenoiser) {
    const ProcessResult plain = render("cornell", "a.pfm"), denoised = render("cornell", "b.pfm", {"--denoise=claray"});
    EXPECT_EQ(plain.output.find("denoised"), std::string::npos) << plain.output;
    EXPECT_NE(denoised.output.find("denoised by claray in "), std::string::npos) << denoised.output;
    EXPECT_NE(read_pfm(path("a.pfm"), 3), read_pfm(path("b.pfm"), 3));
    EXPECT_TRUE(failed_with(render("cornell", "c.pfm", {"--denoise=blur"}), 2, "choose automatic, claray or oidn"));
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "--denoise", "--fps", "10"}), 2,
                            "--denoise and --fps contradict"));
}

TEST_F(Render, ExposureAndToneMapChangeThePicture) {
    ASSERT_EQ(render("cornell", "a.png").exit_code, 0);
    ASSERT_EQ(render("cornell", "b.png", {"--exposure", "-2"}).exit_code, 0);
    ASSERT_EQ(render("cornell", "c.png", {"--tone-map", "none"}).exit_code, 0);
    EXPECT_NE(read_file(path("a.png")), read_file(path("b.png")));
    EXPECT_NE(read_file(path("a.png")), read_file(path("c.png")));
}

TEST_F(Render, CameraFromTheCommandLine) {
    // A triangle in the plane z = 0, seen from z = 2 and from z = 4: depths double in the middle of the image.
    std::ofstream(path("t.obj")) << "v -9 -9 0\nv 9 -9 0\nv 0 18 0\nf 1 2 3\n";
    for (const char* z : {"2", "4"}) {
        const auto result = render(path("t.obj"), "t.png",
                                   {"--camera", std::string("0,0,") + z, "--look-at", "0,0,-1", "--fov", "10", "--up",
                                    "0,1,0", "--aov", "depth"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const std::vector<float> depth = read_pfm(path("t.depth.pfm"), 1);
        ASSERT_EQ(depth.size(), 24u * 16);
        EXPECT_NEAR(depth[8 * 24 + 12], std::atof(z), 0.01 * std::atof(z));
    }
}

TEST_F(Render, AuxiliaryImages) {
    const ProcessResult result =
        render("cornell", "a.png", {"--aov", "depth,normal,albedo", "--aov", "primitive", "heat"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const char* name : {"depth", "normal", "albedo", "primitive", "heat"}) {
        EXPECT_TRUE(read_file(path(std::string("a.") + name + ".png")).starts_with("\x89PNG")) << name;
        const bool color = name == std::string("normal") || name == std::string("albedo");
        EXPECT_EQ(read_pfm(path(std::string("a.") + name + ".pfm"), color ? 3 : 1).size(), 24u * 16 * (color ? 3 : 1))
            << name;
    }
    EXPECT_EQ(file_count(), 11u);
    const std::vector<float> normals = read_pfm(path("a.normal.pfm"), 3);
    const float* middle = &normals[3 * (8 * 24 + 12)];
    EXPECT_NEAR(middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2], 1.f, 1e-4f);
}

TEST_F(Render, GBuffer) {
    const ProcessResult result = render("cornell", "a.png", {"--aov", "gbuffer"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const char* name : {"albedo", "material", "normal", "depth", "position"})
        EXPECT_TRUE(read_file(path(std::string("a.gbuffer-") + name + ".png")).starts_with("\x89PNG")) << name;
    EXPECT_EQ(read_file(path("a.gbuffer.raw")).size(), 24u * 16 * 12);
    EXPECT_EQ(file_count(), 7u);
}

TEST_F(Render, Approximations) {
    const auto with = [&](const char* names) {
        return render("spheres", "a.png", {"--approximate", names, "--light", "point,position=0,3,0,intensity=9"});
    };
    EXPECT_EQ(with("tile-sum").exit_code, 0);
    const ProcessResult unknown = with("tile-sun");
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.errors.find("--approximate: unknown name 'tile-sun'"), std::string::npos) << unknown.errors;
    EXPECT_NE(unknown.errors.find("tile-sum"), std::string::npos) << unknown.errors;
}

TEST_F(Render, StatisticsAndTrace) {
    const ProcessResult text = render("soup:1000", "a.png", {"--stats"});
    for (const char* words : {"build ", "camera rays", "shadow rays", "Mrays/s", "1000 triangles", "memory"})
        EXPECT_NE(text.output.find(words), std::string::npos) << words;

    const ProcessResult json = render(
        "soup:1000", "a.png", {"--json", "--trace", path("trace.json"), "--morton-bits", "30", "--layout", "binary"});
    ASSERT_EQ(json.exit_code, 0) << json.errors;
    const auto report = nlohmann::json::parse(json.output);
    EXPECT_EQ(report.at("spp"), 2);
    EXPECT_EQ(report.at("width"), 24);
    EXPECT_EQ(report.at("interrupted"), false);
    EXPECT_EQ(report.at("build").at("triangles"), 1000);
    EXPECT_EQ(report.at("rays").at("camera").at("rays"), 24 * 16 * 2);
    EXPECT_GT(report.at("build").at("milliseconds"), 0);
    EXPECT_GT(report.at("device_bytes"), 1000);

    const auto trace = nlohmann::json::parse(read_file(path("trace.json")));
    bool has_build = false;
    for (const auto& event : trace.at("traceEvents"))
        has_build |= event.at("name").get<std::string>().starts_with("build_");
    EXPECT_TRUE(has_build);
}

TEST_F(Render, ProgressIsPlainLinesOffATerminal) {
    const ProcessResult result = render("cornell", "a.png");
    EXPECT_NE(result.errors.find("/2 spp"), std::string::npos) << result.errors;
    EXPECT_EQ(result.errors.find('\r'), std::string::npos);
    EXPECT_EQ(result.errors.find('\x1b'), std::string::npos);
    EXPECT_EQ(render("cornell", "a.png", {"--quiet"}).errors, "");
}

TEST_F(Render, StopsAtItsTimeAndAtItsNoise) {
    const std::vector<std::string> endless = {"--spp", "10000000", "--json"};
    std::vector<std::string> time = endless, noise = endless;
    time.insert(time.end(), {"--time", "0.5"});
    noise.insert(noise.end(), {"--noise", "0.2", "--time", "60"});
    const auto timed = nlohmann::json::parse(render("cornell", "a.png", time).output);
    EXPECT_LT(timed.at("spp"), 10000000);
    const auto quiet = nlohmann::json::parse(render("cornell", "a.png", noise).output);
    EXPECT_LE(quiet.at("noise"), 0.2);
    EXPECT_GT(quiet.at("noise"), 0.0);
    EXPECT_LT(quiet.at("spp"), 10000000);
}

class Signals : public Render, public testing::WithParamInterface<int> {};

TEST_P(Signals, StopWithTheImageThatExists) {
    Process process(
        claray_command({"render", "cornell", "-o", path("a.png"), "--size", "64x64", "--spp", "1000000", "--json"}),
        {{"CLARAY_DEVICE", std::to_string(device().info().index)}});
    wait_for_samples(process);
    process.send(GetParam());
    const ProcessResult result = process.wait();
    ASSERT_EQ(result.exit_code, 128 + GetParam()) << "shells end their loops only then: " << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    EXPECT_EQ(report.at("interrupted"), true);
    EXPECT_GT(report.at("spp"), 0);
    EXPECT_LT(report.at("spp"), 1000000);
    EXPECT_TRUE(read_file(path("a.png")).starts_with("\x89PNG"));
    EXPECT_EQ(file_count(), 1u);
}

INSTANTIATE_TEST_SUITE_P(All, Signals, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT));

}  // namespace
}  // namespace claray::test
