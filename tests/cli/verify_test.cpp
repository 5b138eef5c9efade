// claray verify: what it prints and writes, and that it notices textbook kernels.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "claray/verify.hpp"
#include "host/verify/probes/probes.hpp"
#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

TEST(VerifyCommand, ListsAllCases) {
    const ProcessResult result = run_claray({"verify", "--list"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const VerifyCase& c : verify_cases()) EXPECT_NE(result.output.find(c.name + ' '), std::string::npos) << c.name;
}

TEST(VerifyCommand, TellsWhatHolds) {
    const ProcessResult result =
        run_claray({"verify", "--case", "approximations", "--case", "float-atomics", "--json", "-"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto report = nlohmann::json::parse(result.output);
    EXPECT_EQ(report.at("holds"), true);
    ASSERT_EQ(report.at("cases").size(), 2u);
    EXPECT_EQ(report.at("cases")[0].at("case"), "approximations");
    EXPECT_EQ(report.at("cases")[0].at("checks")[0].at("tried"), 100'000);
}

TEST(VerifyCommand, TellsWhichKernelsTheCasesRun) {
    const std::set<std::string> kernels = kernel_names();
    for (const char* name : {"trace_paths", "closest_hit", "shade_surface", "sort_digit"})
        EXPECT_TRUE(kernels.contains(name)) << name;
    const ProcessResult result = run_claray({"verify", "--case", "sort", "--kernels", "--no-times"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const auto line_of = [&](const std::string& kernel) {
        const std::size_t begin = result.output.find('\n' + kernel + ' ') + 1;
        return result.output.substr(begin, result.output.find('\n', begin) - begin);
    };
    EXPECT_TRUE(line_of("trace_paths").ends_with(" none")) << line_of("trace_paths");
    EXPECT_NE(result.output.find(" sort\n"), std::string::npos) << result.output;
    EXPECT_NE(result.output.find(" of " + std::to_string(kernels.size()) + " kernels are run"), std::string::npos);
}

/// Moeller and Trumbore's test in place of the shipped one must be noticed, named, drawn, and repeated by the command
/// that is printed.
TEST(VerifyCommand, NoticesATextbookKernel) {
    const TemporaryFolder folder;
    const std::string tuning = (folder / "batch.txt").string(), html = (folder / "report.html").string();
    const std::string tap = (folder / "report.tap").string(), junit = (folder / "report.xml").string();
    for (const char* part : {"kernels", "include"})
        std::filesystem::copy(std::filesystem::path(CLARAY_SOURCE_DIR) / part, folder / part,
                              std::filesystem::copy_options::recursive);
    const std::filesystem::path textbook = folder / "kernels/compute/textbook.clh";
    const std::string shipped = read_file(textbook);
    std::ofstream(textbook) << "#define CLARAY_TEXTBOOK_TRIANGLES 1\n" << shipped;
    std::ofstream(tuning) << "* trace/closest_hit BATCH 0\n";
    const Variables environment = {{"CLARAY_TUNING", tuning}, {"CLARAY_KERNEL_DIR", (folder / "kernels").string()}};
    const ProcessResult result = run_claray({"verify", "--case", "edges", "--case", "float-atomics", "--seed", "3",
                                             "--html", html, "--tap", tap, "--junit", junit},
                                            environment);
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_NE(result.errors.find("1 of 2 cases fail"), std::string::npos) << result.errors;
    EXPECT_NE(result.output.find("repeat: claray verify --case edges --quick --seed 3"), std::string::npos);
    EXPECT_NE(result.output.find("origin 0x"), std::string::npos) << "the ray that leaks";
    const std::string report = read_file(html);
    EXPECT_NE(report.find("<svg"), std::string::npos) << "no picture of the leak";
    EXPECT_EQ(report.find("http"), std::string::npos) << "it must need nothing from elsewhere";
    EXPECT_NE(report.find("</html>"), std::string::npos);
    const std::string lines = read_file(tap), xml = read_file(junit);
    EXPECT_TRUE(lines.starts_with("TAP version 14\n1..2\nnot ok 1 - edges\n  ---\n  reasons: |\n")) << lines;
    EXPECT_TRUE(lines.ends_with("  ...\nok 2 - float-atomics\n")) << lines;
    EXPECT_NE(xml.find("tests=\"2\" failures=\"1\""), std::string::npos) << xml;
    EXPECT_NE(xml.find("<testcase classname=\"verify\" name=\"edges\""), std::string::npos) << xml;
    EXPECT_NE(xml.find("repeat: claray verify --case edges --quick --seed 3"), std::string::npos) << xml;
}

/// No case ends within a hundredth of a second: each fails with one line, and the others go on.
TEST(VerifyCommand, EndsCasesThatTakeTooLong) {
    const ProcessResult result =
        run_claray({"verify", "--case", "sort", "--case", "tree-hashes", "--limit", "10ms", "--no-times"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_NE(result.errors.find("2 of 2 cases fail"), std::string::npos) << result.errors;
    for (const char* name : {"sort", "tree-hashes"}) {
        const std::size_t line = result.output.find(std::string("\n") + name + " ");
        ASSERT_NE(line, std::string::npos) << result.output;
        EXPECT_NE(result.output.find("\n  killed after 0.01 s without an end\n  repeat: claray verify --case ", line),
                  std::string::npos)
            << result.output;
    }
    EXPECT_TRUE(failed_with(run_claray({"verify", "--limit", "0"}), 2, "--limit"));
}

TEST(VerifyCommand, RefusesWhatItDoesNotKnow) {
    EXPECT_TRUE(failed_with(run_claray({"verify", "--case", "no-such-case"}), 2, "choose one of arithmetic"));
    EXPECT_TRUE(failed_with(run_claray({"verify", "--compare", "--case", "no-such-case"}), 2, "choose one of"));
    EXPECT_TRUE(failed_with(run_claray({"verify", "--quick", "--full"}), 2, "--quick"));
    EXPECT_TRUE(
        failed_with(run_claray({"verify", "--case", "srgb", "--json", "/no/such/folder/x.json"}), 1, "/no/such"));
}

TEST(VerifyCommand, ReductionWritesTheProbesThatAreNamed) {
    const TemporaryFolder folder;
    const std::filesystem::path to = folder / "new/faults";
    const ProcessResult result =
        run_claray({"verify", "--reduce", to.string(), "--case", "fills", "--case", "long-loops"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const std::string name : {"fills", "long-loops"}) {
        EXPECT_EQ(read_file(to / (name + ".cl")), verify::probe_texts(name).kernel);
        EXPECT_EQ(read_file(to / (name + ".c")), verify::probe_texts(name).program);
        EXPECT_NE(result.output.find("cc " + name + ".c -lOpenCL -o " + name), std::string::npos) << result.output;
    }
}

TEST(VerifyCommand, ReductionSaysInOneLineThatNothingFails) {
    const TemporaryFolder folder;
    const ProcessResult result = run_claray({"verify", "--reduce", folder.path().string(), "--case", "srgb"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(result.output, "none of these cases fails: there is nothing to reduce\n");
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VerifyCommand, ReductionRefusesWhatItCannotWrite) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "no folder";
    EXPECT_TRUE(
        failed_with(run_claray({"verify", "--reduce", (folder / "file").string(), "--case", "fills"}), 1, "file"));
    EXPECT_TRUE(failed_with(run_claray({"verify", "--reduce", "x", "--json", "y"}), 2, "--reduce writes programs"));
}

}  // namespace
}  // namespace claray::test
