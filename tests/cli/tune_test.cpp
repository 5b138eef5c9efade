// claray tune: its table, its file, its bad input.
#include <fstream>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

ProcessResult tune(std::vector<std::string> more, const Variables& environment = {}) {
    return run_claray(with({"tune", "--scene", "soup:300", "--size", "16x8", "--repeat", "3", "--only",
                            "trace/any_hit GROUP_SIZE", "--device", std::to_string(device().info().index)},
                           more),
                      environment);
}

TEST(TuneCommand, PrintsWhatItTried) {
    const ProcessResult result = tune({"--dry-run"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const char* words : {"trace/any_hit GROUP_SIZE", "in force", "noise"})
        EXPECT_NE(result.output.find(words), std::string::npos) << words;
    const bool rows = result.output.find("rows for a tuning table") != std::string::npos;
    const bool none = result.output.find("no value is faster") != std::string::npos;
    EXPECT_NE(rows, none) << result.output;
}

TEST(TuneCommand, WritesATableThatIsReadAgain) {
    const TemporaryFolder folder;
    const Variables home = {{"XDG_CONFIG_HOME", folder.path().string()}};
    const ProcessResult result = tune({}, home);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto table = folder / "claray/tuning.txt";
    EXPECT_EQ(std::filesystem::exists(table), result.output.find("rows written to") != std::string::npos);
    EXPECT_EQ(run_claray({"bench", "soup:10", "--size", "8x8", "--repeat", "1"}, home).exit_code, 0);
}

TEST(TuneCommand, RowsThatAreIgnoredAreNamed) {
    const TemporaryFolder folder;
    std::ofstream(folder / "mine.txt") << "\n* trace/closest_hit CLARAY_TEXTBOOK_TRIANGLES 1\n";
    const ProcessResult result = run_claray({"bench", "soup:10", "--size", "8x8", "--repeat", "1"},
                                            {{"CLARAY_TUNING", (folder / "mine.txt").string()}});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(
        result.errors.find("claray: warning: " + (folder / "mine.txt").string() +
                           ":2: ignored: 'trace/closest_hit CLARAY_TEXTBOOK_TRIANGLES' is not a tuning parameter"),
        std::string::npos)
        << result.errors;
}

TEST(TuneCommand, BadInput) {
    EXPECT_TRUE(failed_with(run_claray({"tune", "--repeat", "1"}), 2, "--repeat: '1' is not a whole number in 3.."));
    EXPECT_TRUE(failed_with(tune({"-o", "/no/such/folder/t.txt"}), 1, "/no/such/folder"));
    EXPECT_TRUE(failed_with(tune({"nonsense"}), 2, "nonsense"));
    EXPECT_TRUE(failed_with(run_claray({"tune", "--dry-run", "--only", "nonsense"}), 2,
                            "no parameter contains 'nonsense'; choose part of plan/model, "));
}

}  // namespace
}  // namespace claray::test
