// claray explain, and the overrides of effects.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "claray/program.hpp"
#include "host/compute/programs/build_report.hpp"
#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

std::size_t count(const std::string& text, const std::string& words) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++found;
    return found;
}

TEST(Explain, SaysWhatIsCalledForAndByWhat) {
    const TemporaryFolder folder;
    const std::string svg = (folder / "cost.svg").string();
    const ProcessResult result =
        run_claray({"explain", "cornell", "--size", "16x16", "--rounds", "3", "--only",
                    "lambert,emissive-triangles,mirror", "--no-compile-times", "--json", "-q", "--svg", svg});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    const auto report = nlohmann::json::parse(result.output);
    const auto& effects = report.at("effects");
    ASSERT_EQ(effects.size(), 3u);
    const auto row = [&](const char* name) {
        return *std::find_if(effects.begin(), effects.end(), [&](auto& e) { return e.at("name") == name; });
    };
    EXPECT_EQ(row("lambert").at("by"), "the material 'white'");
    EXPECT_EQ(row("lambert").at("count"), 4);
    EXPECT_EQ(row("mirror").at("called_for"), false);
    EXPECT_EQ(row("mirror").at("by"), nullptr);
    EXPECT_EQ(row("mirror").at("bytes"), 0);
    // Without its lamp the box needs no queue of shadow rays.
    EXPECT_EQ(row("emissive-triangles").at("by"), "the material 'light'");
    EXPECT_GT(row("emissive-triangles").at("bytes"), 16 * 16 * 32);
    EXPECT_GT(row("emissive-triangles").at("without").at("milliseconds"), 0);
    EXPECT_GT(report.at("own").at("milliseconds"), 0);
    EXPECT_GT(report.at("full_ratio"), 0);

    const std::string chart = read_file(svg);
    EXPECT_TRUE(chart.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\"")) << chart.substr(0, 80);
    EXPECT_EQ(count(chart, "<svg"), count(chart, "</svg>"));
    for (const char* label : {">emissive-triangles<", ">mirror<", ">everything<"}) EXPECT_EQ(count(chart, label), 1u);
    EXPECT_EQ(count(chart, ">noise<"), 3u) << "three rounds tell nothing: neither do figures";
    EXPECT_EQ(count(chart, "http"), 1u) << "it must need nothing from elsewhere";
}

TEST(Explain, ListsWhatIsCalledForFirstAndNoTimesThatItDidNotMeasure) {
    const ProcessResult result = run_claray({"explain", "cornell", "--size", "16x16", "--rounds", "3", "--only",
                                             "lambert,emissive-triangles,mirror", "--no-compile-times"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const std::string& text = result.output;
    EXPECT_LT(text.find("  lambert                  the material 'white' and 3 more\n"), text.find("ms with"));
    EXPECT_EQ(text.find("compiled in"), std::string::npos) << text;
    EXPECT_EQ(text.find("to compile"), std::string::npos) << text;
    EXPECT_NE(result.errors.find("without emissive-triangles (3 of 3)"), std::string::npos) << result.errors;
}

TEST(Explain, CountsLightsOfTheCommandLine) {
    const ProcessResult result =
        run_claray({"explain", "cornell", "--light", "spot,position=0.3,0.5,0.3", "--size", "8x8", "--rounds", "1",
                    "--only", "spot-lights,tile-sum,light-grid", "--no-compile-times", "--json", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const nlohmann::json report = nlohmann::json::parse(result.output);
    EXPECT_EQ(report["effects"][0]["called_for"], true);
    ASSERT_EQ(report["approximations"].size(), 2u) << "the scene has a light without extent, and diffuse surfaces";
    EXPECT_EQ(report["approximations"][0]["name"], "tile-sum");
    EXPECT_GT(report["approximations"][0]["error"], 0.1) << "the lamp lights nothing";
    EXPECT_EQ(report["approximations"][1]["name"], "light-grid");
}

TEST(Explain, RefusesWhatItDoesNotKnow) {
    EXPECT_TRUE(failed_with(run_claray({"explain", "cornell", "--only", "mirror,stars"}), 2, "'stars'"));
    EXPECT_TRUE(failed_with(run_claray({"explain", "cornell", "--effects", "+mirror"}), 2, "all effects"));
    EXPECT_TRUE(failed_with(run_claray({"explain", "no_such_scene"}), 2, "no_such_scene"));
}

TEST(Explain, RegistersAreReadFromTheLog) {
    BuildReport report;
    read_build_log("", report);
    EXPECT_FALSE(report.registers || report.spill_bytes);
    read_build_log(
        "ptxas info    : 0 bytes gmem\n"
        "ptxas info    : Function properties for first\n"
        "ptxas         .     8 bytes stack frame, 12 bytes spill stores, 16 bytes spill loads\n"
        "ptxas info    : Used 64 registers, 380 bytes cmem[0]\n"
        "ptxas info    : Function properties for second\n"
        "ptxas         .     0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads\n"
        "ptxas info    : Used 128 registers, 380 bytes cmem[0]\n",
        report);
    EXPECT_EQ(report.registers, 128u);
    EXPECT_EQ(report.spill_bytes, 12u);
}

/// Programs that PoCL has compiled, by its cache on disk.
std::size_t programs_of_pocl() {
    const char* folder = std::getenv("POCL_CACHE_DIR");
    const std::filesystem::path cache =
        folder ? folder : std::filesystem::path(std::getenv("HOME")) / ".cache/pocl/kcache";
    std::size_t programs = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache))
        programs += entry.path().filename() == "program.bc";
    return programs;
}

TEST(Explain, BuildsAreTimedPastEveryCache) {
    const Defines defines = {{"SAMPLER", "0"}};
    const bool is_pocl = device().info().platform == "Portable Computing Language";
    for (int i = 0; i < 2; ++i) {
        const unsigned compiled = compile_statistics().compiled;
        const std::size_t programs = is_pocl ? programs_of_pocl() : 0;
        EXPECT_GT(report_build(device(), "render/generate_rays.cl", defines).milliseconds, 0);
        EXPECT_EQ(compile_statistics().compiled, compiled + 1);
        EXPECT_GT(is_pocl ? programs_of_pocl() : 1, programs) << i;
    }
}

TEST(Effects, OverridesAreSaid) {
    const TemporaryFolder folder;
    const std::string image = (folder / "a.pfm").string();
    const std::vector<std::string> render = {
        "render", "cornell", "-o", image, "--size", "8x8", "--spp", "1", "--effects", "+mirror,-smooth-normals", "-q"};
    const ProcessResult text = run_claray(render);
    ASSERT_EQ(text.exit_code, 0) << text.errors;
    EXPECT_EQ(
        count(text.output, "effects are overridden: compiled in: mirror; removed from the scene: smooth-normals\n"), 1u)
        << text.output;
    std::vector<std::string> with_json = render;
    with_json.emplace_back("--json");
    const auto report = nlohmann::json::parse(run_claray(with_json).output);
    EXPECT_EQ(report.at("effect_overrides").at("add"), nlohmann::json({"mirror"}));
    EXPECT_EQ(report.at("effects"), nlohmann::json({"lambert", "emissive-triangles"}));
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", image, "--effects", "+stars"}), 2, "'stars'"));
}

}  // namespace
}  // namespace claray::test
