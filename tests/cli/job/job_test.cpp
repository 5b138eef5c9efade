// claray render JOB.json: what is printed renders the same bits again.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Jobs : public InFolder {
protected:
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    /// What a job of this text ends with.
    [[nodiscard]] testing::AssertionResult fails(const std::string& text, int exit_code,
                                                 const std::string& words) const {
        write("bad.json", text);
        return failed_with(run_claray({"render", path("bad.json")}), exit_code, words);
    }
    const std::vector<std::string> quick = {"--size", "24x16", "--spp", "2", "-q"};
};

TEST_F(Jobs, WhatIsPrintedRendersTheSameBits) {
    write("t.obj", "v -1 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    const std::vector<std::string> settings = {"--seed",
                                               "7",
                                               "--camera",
                                               "-0.1,1.3,5",
                                               "--look-at",
                                               "0,1,0",
                                               "--tone-map",
                                               "none",
                                               "--no-guide",
                                               "--sky",
                                               "0.5,1,2",
                                               "--light",
                                               "point,position=0,3,3,intensity=9",
                                               "--light",
                                               "sun,direction=0,-1,-1,intensity=1",
                                               "--aov",
                                               "depth,normal",
                                               "--denoise=claray",
                                               "--sample-clamp",
                                               "1e3",
                                               "--front",
                                               "cw",
                                               "--approximate",
                                               "tile-sum"};
    const auto arguments =
        with(with({"render", path("t.obj"), "-o", path("a.png"), "--png-bits", "16"}, quick), settings);
    ASSERT_EQ(run_claray(arguments).exit_code, 0);
    const ProcessResult printed = run_claray(with(arguments, {"--print-job"}));
    ASSERT_EQ(printed.exit_code, 0) << printed.errors;
    const auto job = nlohmann::json::parse(printed.output);
    EXPECT_EQ(job.at("spp"), 2);
    EXPECT_EQ(job.at("guide"), false);
    EXPECT_EQ(job.at("tone-map"), "none");
    EXPECT_EQ(job.at("denoise"), "claray");
    EXPECT_EQ(job.at("camera"), nlohmann::json({-0.1, 1.3, 5}));
    EXPECT_EQ(job.at("aov"), nlohmann::json({"depth", "normal"}));
    EXPECT_FALSE(job.contains("print-job") || job.contains("max-depth")) << "only what was chosen";
    write("job.json", printed.output);
    const ProcessResult again = run_claray({"render", path("job.json"), "-o", path("b.png")});
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_EQ(again.errors, "") << "its -q";
    EXPECT_TRUE(read_file(path("a.png")) == read_file(path("b.png")));
    EXPECT_TRUE(read_file(path("a.depth.pfm")) == read_file(path("b.depth.pfm")));
    EXPECT_EQ(run_claray({"render", path("job.json"), "-o", path("a.png"), "--print-job"}).output, printed.output);
}

TEST_F(Jobs, PathsBeginAtTheJobAndOptionsOverride) {
    fs::create_directory(path("scenes"));
    write("scenes/t.obj", "v -1 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    write("scenes/job.json", R"({"scene": "t.obj", "output": "out.pfm", "size": "24x16", "spp": 2, "quiet": true,
                                 "seed": 3, "aov": ["depth"], "denoise": false, "$schema": "render.schema.json"})");
    ASSERT_EQ(run_claray({"render", path("scenes/job.json")}).exit_code, 0);
    EXPECT_TRUE(fs::exists(path("scenes/out.pfm")) && fs::exists(path("scenes/out.depth.pfm")));
    const auto other = run_claray({"render", "--seed", "4", path("scenes/job.json"), "-o", path("b.pfm")});
    ASSERT_EQ(other.exit_code, 0) << other.errors;
    EXPECT_TRUE(fs::exists(path("b.depth.pfm"))) << "an option that is not overridden stays";
    const auto chosen = nlohmann::json::parse(
        run_claray({"render", path("scenes/job.json"), "--seed", "4", "--aov", "heat", "--print-job"}).output);
    EXPECT_EQ(chosen.at("seed"), 4);
    EXPECT_EQ(chosen.at("aov"), nlohmann::json({"heat"})) << "in place of the job's";
    EXPECT_EQ(chosen.at("scene"), path("scenes/t.obj"));
    write("built-in.json",
          R"({"scene": "cornell", "output": "-", "format": "png", "size": "8x8", "spp": 1, "quiet": true})");
    EXPECT_TRUE(run_claray({"render", path("built-in.json")}).output.starts_with("\x89PNG"));
}

TEST_F(Jobs, MistakesAreOneLine) {
    const std::string begin = R"({"scene": "cornell", "output": "a.png", )";
    EXPECT_TRUE(fails(begin + R"("sppp": 4})", 2, "bad.json': unknown key 'sppp' (did you mean 'spp'?); see claray"));
    EXPECT_TRUE(fails(begin + R"("spp": "4"})", 2, "bad.json': 'spp' is of the type string; write a number"));
    EXPECT_TRUE(fails(begin + R"("guide": 1})", 2, "'guide' is of the type number; write true or false"));
    EXPECT_TRUE(fails(begin + R"("aov": {"depth": 1}})", 2, "'aov' is of the type object; write text, or a list"));
    EXPECT_TRUE(
        fails(begin + R"("camera": [1, null, 2]})", 2, "'camera' is of the type array; write a list of numbers"));
    EXPECT_TRUE(fails(begin + R"("tone-map": "acse"})", 2, "--tone-map: unknown name 'acse' (did you mean 'aces'?)"));
    EXPECT_TRUE(fails(begin + R"("spp": 0})", 2, "--spp: '0' is not a whole number in 1..16777216"));
    EXPECT_TRUE(fails(begin + R"("help": true})", 2, "unknown key 'help'"));
    EXPECT_TRUE(fails(begin + R"("frames": "0..1", "trace": "t.json"})", 2, "--frames and --trace contradict"));
    EXPECT_TRUE(fails(R"({"output": "a.png"})", 2, "the scene is missing"));
    EXPECT_TRUE(fails(R"({"scene": "cornell"})", 2, "--output"));
    EXPECT_TRUE(fails("[1]", 2, "it is array; write an object of options"));
    EXPECT_TRUE(fails("{\n\"scene\" 1}", 1, "is no JSON: line 2, column 9"));
    EXPECT_TRUE(failed_with(run_claray({"render", path("none.json"), "-o", "a.png"}), 1, "none.json': No such file"));
    EXPECT_FALSE(fs::exists(path("a.png")));
}

/// Its content decides: a glTF may be called .json.
TEST_F(Jobs, AGltfIsNoJob) {
    fs::copy_file(std::string(CLARAY_SOURCE_DIR) + "/tests/fuzz/corpus/gltf/posed.gltf", path("posed.json"));
    const auto result = run_claray(with({"render", path("posed.json"), "-o", path("a.pfm")}, quick));
    EXPECT_EQ(result.exit_code, 0) << result.errors;
}

TEST_F(Jobs, TheSchemaHasEveryOption) {
    const ProcessResult result = run_claray({"render", "--job-schema"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto schema = nlohmann::json::parse(result.output);
    const auto& properties = schema.at("properties");
    EXPECT_EQ(schema.at("additionalProperties"), false);
    EXPECT_EQ(properties.at("spp").at("type"), "number");
    EXPECT_EQ(properties.at("adaptive").at("type"), "boolean");
    EXPECT_EQ(properties.at("tone-map").at("enum"), nlohmann::json({"none", "aces"}));
    EXPECT_EQ(properties.at("aov").at("anyOf").at(1).at("items").at("enum").at(0), "depth");
    EXPECT_EQ(properties.at("camera").at("anyOf").at(1).at("items").at("type"), "number");
    EXPECT_EQ(properties.at("denoise").at("anyOf").at(0).at("type"), "boolean");
    EXPECT_TRUE(properties.contains("scene") && properties.contains("grid-voxels") && !properties.contains("help"));
    const auto help = run_claray({"render", "--help-all"}).output;
    for (const auto& [key, value] : properties.items())
        EXPECT_TRUE(key == "scene" || key == "$schema" || help.find("--" + key) != std::string::npos) << key;
}

}  // namespace
}  // namespace claray::test
