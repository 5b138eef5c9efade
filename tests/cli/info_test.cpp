// claray info: the contents of scenes.
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

TEST(Info, CountsWhatAFileContains) {
    const TemporaryFolder folder;
    const std::string file = (folder / "two.obj").string();
    std::ofstream(file) << "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 -1\nf 1 2 3\nf 1 2 4\n";
    const ProcessResult result = run_claray({"info", file, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto info = nlohmann::json::parse(result.output);
    EXPECT_EQ(info.at("triangles"), 2);
    EXPECT_EQ(info.at("lights"), 0);
    EXPECT_EQ(info.at("from"), (std::vector<float>{0, 0, -1}));
    EXPECT_EQ(info.at("to"), (std::vector<float>{2, 3, 0}));
    const std::string table = run_claray({"info", file}).output;
    EXPECT_NE(table.find("from 0,0,-1 to 2,3,0\n"), std::string::npos) << table;
}

TEST(Info, NamesTheEffectsOfAScene) {
    const ProcessResult result = run_claray({"info", "cornell"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("effects: lambert, emissive-triangles\n"), std::string::npos) << result.output;
}

TEST(Info, RefusesFilesThatDoNotExist) {
    const ProcessResult result = run_claray({"info", "missing.obj"});
    EXPECT_NE(result.exit_code, 0);
    EXPECT_NE(result.errors.find("missing.obj"), std::string::npos);
}

}  // namespace
}  // namespace claray::test
