// claray render --error and --time: what is printed, what is refused.
#include <nlohmann/json.hpp>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

class Target : public InFolder {
protected:
    [[nodiscard]] ProcessResult render(const std::vector<std::string>& more) const {
        return run_claray(with({"render", "hills", "-o", path("a.pfm"), "--size", "24x24", "-q"}, more));
    }
};

TEST_F(Target, ErrorIsReachedAndToldOf) {
    const ProcessResult text = render({"--error", "0.05", "--stats"});
    ASSERT_EQ(text.exit_code, 0) << text.errors;
    for (const char* words :
         {"samples: ", "tree: ", "reached: error of 0.05, in ", ": about 0.0", "measuring     noise"})
        EXPECT_NE(text.output.find(words), std::string::npos) << words << " in " << text.output;
    const ProcessResult quiet = render({"--error", "0.05"});
    EXPECT_EQ(quiet.output.find("tree: "), std::string::npos) << quiet.output;
    const ProcessResult json = render({"--error", "0.05", "--json"});
    ASSERT_EQ(json.exit_code, 0) << json.errors;
    const auto report = nlohmann::json::parse(json.output);
    EXPECT_LE(report.at("error_bound"), 0.05);
    EXPECT_GT(report.at("error"), 0);
    EXPECT_EQ(report.at("target").at("error"), 0.05);
    EXPECT_GE(report.at("target").at("picks").size(), 2u);
}

TEST_F(Target, TimesHaveUnits) {
    for (const char* time : {"0.2", "0.2s", "200ms"}) {
        const ProcessResult result = render({"--time", time, "--json"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const auto report = nlohmann::json::parse(result.output);
        EXPECT_EQ(report.at("target").at("seconds"), 0.2);
        EXPECT_GE(report.at("seconds"), 0.2);
        EXPECT_GE(report.at("spp"), 1) << "as many samples as fit";
    }
}

TEST_F(Target, ErrorGoesOnFromACheckpoint) {
    const ProcessResult first = render({"--error", "0.1", "--checkpoint", path("c")});
    ASSERT_EQ(first.exit_code, 0) << first.errors;
    const ProcessResult finer = render({"--error", "0.05", "--resume", path("c"), "--json"});
    ASSERT_EQ(finer.exit_code, 0) << finer.errors;
    EXPECT_LE(nlohmann::json::parse(finer.output).at("error_bound"), 0.05);
    EXPECT_EQ(render({"--spp", "4096", "--resume", path("c")}).exit_code, 0) << "without an error";
}

TEST_F(Target, WhatWasMissedIsToldAfterTheImageIsWritten) {
    for (const char* error : {"0.0005", "1e-9"}) {
        const ProcessResult result = render({"--error", error, "--time", "500ms", "--stats"});
        EXPECT_TRUE(failed_with(
            result, 1, std::string(" instead of ") + (error[0] == '1' ? "1e-09" : error) + ", which needs about"));
        EXPECT_NE(result.output.find("missed: error of "), std::string::npos) << result.output;
        EXPECT_TRUE(std::filesystem::remove(path("a.pfm")));
    }
}

TEST_F(Target, FramesAreCountedAndTimed) {
    const ProcessResult result = run_claray(
        {"render", "hills", "--size", "16x16", "--fps", "50", "--frames", "3", "-o", path("last.pfm"), "--json"});
    // Whether a busy machine holds the rate is no matter of this test.
    const bool late = result.errors.find("50 frames per second were not reached") != std::string::npos;
    ASSERT_EQ(result.exit_code, late ? 1 : 0) << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    EXPECT_EQ(report.at("frames"), 3);
    EXPECT_GE(report.at("spp"), 1);
    EXPECT_LE(report.at("max_depth"), 128);
    EXPECT_EQ(report.at("milliseconds").at("promised"), 20);
    EXPECT_LE(report.at("milliseconds").at("median"), report.at("milliseconds").at("percentile_99"));
    EXPECT_TRUE(std::filesystem::exists(path("last.pfm")));
    const ProcessResult text = run_claray({"render", "hills", "--size", "16x16", "--fps", "50", "--frames", "2"});
    EXPECT_NE(text.output.find(": 2 of 2 frames of 16x16"), std::string::npos) << text.output;
}

TEST_F(Target, BadInput) {
    for (const char* value : {"-1", "nan", "inf", "small", "0%"})
        EXPECT_TRUE(failed_with(render({"--error", value}), 2, "--error: '" + std::string(value) + "' is not"))
            << value;
    for (const char* value : {"-1s", "2parsecs", "nan", "inf", "0parsecs", "s"})
        EXPECT_TRUE(failed_with(render({"--time", value}), 2, "--time")) << value;
    EXPECT_TRUE(failed_with(render({"--error", "0.1", "--spp", "4"}), 2, "--error and --spp contradict each other"));
    EXPECT_TRUE(failed_with(render({"--error", "0.1", "--noise", "0.1"}), 2, "--error and --noise contradict"));
    EXPECT_TRUE(failed_with(render({"--time", "1us"}), 1, "a time of 1 us is too short: one sample for every pixel"));
    for (const char* value : {"0", "0s", "0.0 ms"})
        EXPECT_TRUE(failed_with(render({"--time", value}), 2, "is not a time of more than 0")) << value;
    EXPECT_TRUE(failed_with(render({"--error", "1e-9"}), 1, "an error of 1e-09 cannot be reached"));
    for (const char* value : {"0", "0.00"})
        EXPECT_TRUE(failed_with(render({"--error", value}), 1, "an error of 0 cannot be reached: it needs about"))
            << value;
    for (const char* other : {"--spp", "--time", "--error", "--noise", "--checkpoint", "--resume"})
        EXPECT_TRUE(failed_with(render({"--fps", "1", other, "1"}), 2, std::string("--fps and ") + other)) << other;
    EXPECT_TRUE(failed_with(render({"--fps", "0"}), 2, "--fps: '0' is not a number of more than 0"));
    EXPECT_TRUE(failed_with(render({"--frames", "3"}), 2, "'3' is not a range of frames"));
    EXPECT_TRUE(failed_with(run_claray({"render", "hills"}), 2, "--output is required"));
    EXPECT_TRUE(failed_with(render({"--fps", "1000000", "--approximate", "no-shadows"}), 1,  // no other is tried
                            "1e+06 frames per second cannot be reached: one sample"));
    EXPECT_FALSE(std::filesystem::exists(path("a.pfm")));
}

}  // namespace
}  // namespace claray::test
