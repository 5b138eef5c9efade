// claray accuracy.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

TEST(Accuracy, WritesPointsAsJsonTableAndReport) {
    const TemporaryFolder folder;
    const std::string csv = (folder / "a.csv").string(), html = (folder / "a.html").string();
    const ProcessResult result = run_claray(
        {"accuracy",      "cornell", "--size", "12x12", "--spp", "4", "--runs", "2",  "--only", "sampling,bias,nodes",
         "--approximate", "nothing", "--rays", "1024",  "--csv", csv, "--html", html, "--json", "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.errors, "");
    const auto report = nlohmann::json::parse(result.output);
    ASSERT_EQ(report.at("studies").size(), 3u);
    const auto& sampling = report.at("studies")[0];
    EXPECT_EQ(sampling.at("name"), "sampling");
    ASSERT_EQ(sampling.at("points").size(), 9u);
    EXPECT_EQ(sampling.at("points")[2].at("setting"), "4 spp");
    EXPECT_GT(sampling.at("points")[0].at("error").at("median"), sampling.at("points")[2].at("error").at("median"));
    EXPECT_EQ(read_file(html).find("<!doctype html>"), 0u);
    EXPECT_NE(read_file(html).find("<svg"), std::string::npos);
    const std::string rows = read_file(csv);
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1 + 9 + 21 + 3);
    EXPECT_EQ(report.at("studies")[2].at("points")[1].at("facts").at("bytes a node"), 48);
}

/// The two CPU devices of PoCL stand for several devices.
TEST(Accuracy, NamesTheDeviceOfEachStudy) {
    const ProcessResult result = run_claray({"accuracy", "cornell", "--size", "12x12", "--spp", "2", "--runs", "1",
                                             "--only", "sampling", "--device", "all", "--json", "-q"},
                                            {{"POCL_DEVICES", "basic pthread"}});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto study = nlohmann::json::parse(result.output).at("studies").at(0);
    const ProcessResult devices = run_claray({"devices"}, {{"POCL_DEVICES", "basic pthread"}});
    const auto name = study.at("device").get<std::string>();
    EXPECT_NE(devices.output.find(" " + name + " "), std::string::npos) << name;
    EXPECT_GT(study.at("points").size(), 2u);
}

TEST(Accuracy, IsOfTheViewAndTheLightAskedFor) {
    const auto error_in = [](const std::vector<std::string>& view) {
        std::vector<std::string> all = {"accuracy", "effect:lambert", "--size",   "8x8",    "--spp", "1", "--runs",
                                        "1",        "--only",         "sampling", "--json", "-q"};
        all.insert(all.end(), view.begin(), view.end());
        const ProcessResult result = run_claray(all);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return nlohmann::json::parse(result.output)["studies"][0]["points"][0]["error"]["median"].get<double>();
    };
    const double plain = error_in({});
    EXPECT_NE(error_in({"--camera", "0,3,0.1", "--look-at", "0,0,0"}), plain);
    EXPECT_NE(error_in({"--light", "point,position=0,2,1,intensity=20"}), plain);
    EXPECT_NE(error_in({"--max-depth", "1"}), plain);
    EXPECT_TRUE(
        failed_with(run_claray({"accuracy", "cornell", "--camera", "0,0"}), 2, "--camera: '0,0' is not a vector"));
}

TEST(Accuracy, RefusesWhatItDoesNotKnow) {
    EXPECT_TRUE(failed_with(run_claray({"accuracy", "cornell", "--only", "colour"}), 2, "unknown study 'colour'"));
    EXPECT_TRUE(failed_with(run_claray({"accuracy", "cornell", "--svg", "x.svg"}), 2, "--svg plots one study"));
    EXPECT_TRUE(failed_with(run_claray({"accuracy", "no_such_scene.obj"}), 1, "no_such_scene.obj"));
    EXPECT_TRUE(failed_with(run_claray({"accuracy", "cornell", "--html", "/nowhere/x.html"}), 1, "/nowhere/x.html"));
}

}  // namespace
}  // namespace claray::test
