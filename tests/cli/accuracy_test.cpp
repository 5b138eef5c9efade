// claray accuracy.
#include <algorithm>
#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

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

// Killed, so that the program has no chance to write anything at its end.
TEST(Accuracy, LeavesWhatItHasMeasuredWhenItIsKilled) {
    const TemporaryFolder folder;
    const std::string csv = (folder / "a.csv").string(), html = (folder / "a.html").string();
    Process process(claray_command({"accuracy", "cornell", "--size", "8x8", "--spp", "16", "--runs", "1000", "--only",
                                    "nodes,sampling", "--rays", "1024", "--csv", csv, "--html", html, "-q"}),
                    {{"CLARAY_DEVICE", std::to_string(device().info().index)}});
    const auto rows_with = [&](const std::string& text) {
        const std::string rows = std::filesystem::exists(csv) ? read_file(csv) : "";
        int count = 0;
        for (std::size_t at = rows.find(text); at != std::string::npos; at = rows.find(text, at + 1)) ++count;
        return count;
    };
    ASSERT_TRUE(process.brings_about([&] { return rows_with(",sampling,") >= 6; }));
    process.send(SIGKILL);
    ASSERT_EQ(process.wait().exit_code, 128 + SIGKILL);
    EXPECT_EQ(rows_with(",nodes,"), 3);
    EXPECT_GE(rows_with(",sampling,"), 6) << "of an unfinished study, too";
    EXPECT_EQ(rows_with("was not run"), 0);
    EXPECT_EQ(read_file(csv).back(), '\n');
    EXPECT_NE(read_file(html).find("<svg"), std::string::npos) << "of the finished study";
    EXPECT_NE(read_file(html).find("</html>"), std::string::npos);
}

TEST(Accuracy, WritesAPipeOnce) {
    const ProcessResult result =
        run_claray({"accuracy", "cornell", "--size", "8x8", "--spp", "2", "--runs", "2", "--only", "sampling,nodes",
                    "--rays", "1024", "--csv", "/dev/stderr", "-q"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1 + 6 + 3) << result.errors;
}

TEST(Accuracy, WritesNoPlotOfNothing) {
    const TemporaryFolder folder;
    const std::filesystem::path html = folder / "a.html";
    const ProcessResult result =
        run_claray({"accuracy", "cornell", "--size", "8x8", "--spp", "2", "--runs", "1", "--only", "gamma,sums",
                    "--rays", "1024", "--svgs", (folder / "plots").string(), "--html", html.string(), "-q"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("\ngamma: no points: the scene has one light source: there is nothing to add\n"),
              std::string::npos)
        << result.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "plots" / "gamma.svg"));
    EXPECT_TRUE(std::filesystem::exists(folder / "plots" / "sums.svg"));
    const std::string page = read_file(html);
    EXPECT_EQ(page.find("<svg"), page.rfind("<svg")) << "of the other study";
    EXPECT_EQ(page.find("<table"), page.rfind("<table"));
}

/// The two CPU devices of PoCL stand for several devices.
TEST(Accuracy, NamesTheDeviceOfEachStudy) {
    const ProcessResult result = run_claray({"accuracy", "cornell", "--size", "12x12", "--spp", "2", "--runs", "1",
                                             "--only", "sums", "--device", "all", "--json", "-q"},
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
