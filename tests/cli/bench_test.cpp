// claray bench: its tables, its files, its bad input.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

ProcessResult bench(std::vector<std::string> more) {
    return run_claray(
        with({"bench", "--size", "16x8", "--repeat", "1", "--device", std::to_string(device().info().index)}, more));
}

TEST(BenchCommand, TableNamesWhatIsMeasured) {
    const ProcessResult result = bench({"--scene", "soup:400", "--scene", "fan:30", "--stages"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const char* words :
         {"soup:400: 400 triangles", "fan:30: 30 triangles", "fast", "balanced", "Mtri/s", "SAH", "primary", "shadow",
          "bounce", "random", "build_lbvh", "build + trace", "quickest together"})
        EXPECT_NE(result.output.find(words), std::string::npos) << words;
}

TEST(BenchCommand, JsonAndCsvAgree) {
    const TemporaryFolder folder;
    const std::string path = (folder / "bench.csv").string();
    const ProcessResult result = bench({"soup:400", "--preset", "fast", "--layout", "binary", "--json", "--csv", path});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto scene = nlohmann::json::parse(result.output).at(0).at("scenes").at(0);
    ASSERT_EQ(scene.at("presets").size(), 1u);
    const auto preset = scene.at("presets").at(0);
    EXPECT_EQ(preset.at("preset"), "fast");
    EXPECT_EQ(preset.at("layout"), "binary");
    EXPECT_EQ(preset.at("triangles"), 400);
    EXPECT_EQ(preset.at("rays").at("primary").at("rays"), 3 * 16 * 8);
    EXPECT_EQ(preset.at("build_and_trace").at("bounce").size(), 6u);
    EXPECT_EQ(scene.at("quickest").at("bounce").at(0).at("preset"), "fast");

    std::istringstream csv(read_file(path));
    std::string line, primary;
    std::getline(csv, line);
    EXPECT_TRUE(line.starts_with("device,driver,scene,triangles,preset,layout,what,count,milliseconds")) << line;
    while (std::getline(csv, line))
        if (line.find(",primary,") != std::string::npos) primary = line;
    EXPECT_NE(primary.find("\"soup:400\",400,fast,binary,primary,384,"), std::string::npos) << primary;
}

/// The two CPU devices of PoCL stand for several devices.
TEST(BenchCommand, MeasuresDevicesAtOnce) {
    const Variables two = {{"POCL_DEVICES", "basic pthread"}};
    const auto on_two = [&](const std::vector<std::string>& more) {
        return run_claray(with({"bench", "soup:400", "--preset", "fast", "--layout", "binary", "--size", "16x8",
                                "--repeat", "1", "--device"},
                               more),
                          two);
    };
    const ProcessResult result = on_two({"all", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    ASSERT_EQ(report.size(), 3u);
    EXPECT_EQ(report[2].at("at_once").at(1), report[1].at("device"));
    const auto rays = report[2].at("scenes").at(0).at("presets").at(0).at("rays");
    ASSERT_EQ(rays.size(), 4u);
    for (const auto& [kind, speed] : rays.items()) EXPECT_GT(speed.at("mrays_per_second"), 0) << kind;
    const ProcessResult table = on_two({"0,1,0"});
    EXPECT_NE(table.output.find("soup:400: 2 devices at the same time"), std::string::npos) << table.output;
}

TEST(BenchCommand, BadInput) {
    EXPECT_TRUE(failed_with(bench({"--preset", "best"}), 2, "best"));
    EXPECT_TRUE(failed_with(bench({"--repeat", "0"}), 2, "--repeat"));
    EXPECT_TRUE(failed_with(bench({"--size", "16"}), 2, "--size"));
    EXPECT_TRUE(failed_with(bench({"missing.obj"}), 1, "missing.obj"));
    const ProcessResult second_is_missing = bench({"soup:10", "missing.obj"});
    EXPECT_TRUE(failed_with(second_is_missing, 1, "cannot read 'missing.obj'"));
    EXPECT_EQ(second_is_missing.output, "") << "nothing is measured before";
    EXPECT_TRUE(failed_with(bench({"nonsense"}), 2, "nonsense"));
    EXPECT_TRUE(failed_with(bench({"missing.scn"}), 1, "cannot read 'missing.scn': No such file"));
    const TemporaryFolder folder;
    const auto recorded = [&](std::vector<std::uint32_t> words) {
        std::ofstream(folder / "a.scn", std::ios::binary)
            .write(reinterpret_cast<const char*>(words.data()), std::streamsize(4 * words.size()));
        return bench({(folder / "a.scn").string()});
    };
    EXPECT_TRUE(failed_with(recorded({}), 1, "a.scn' is cut off"));
    EXPECT_TRUE(failed_with(recorded({0, 0xffffffffu, 0xffffffffu, 0, 0}), 1, "a.scn' is cut off"));
    EXPECT_TRUE(failed_with(recorded({0, 1, 1, 0, 0, 0, 0, 0, 0, 7}), 1,
                            "a.scn' has a triangle with an index beyond its 1 points"));
    EXPECT_TRUE(failed_with(bench({"soup:10", "--csv", "/no/such/folder/x.csv"}), 1, "/no/such/folder"));
}

}  // namespace
}  // namespace claray::test
