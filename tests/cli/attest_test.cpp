// claray attest: its files, and the page that it makes of them.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

TEST(AttestCommand, WritesAFileOfWhichItMakesAPage) {
    const TemporaryFolder folder;
    const std::string good = (folder / "good.json").string(), bad = (folder / "bad.json").string();
    const ProcessResult held = run_claray({"attest", good, "--case", "tree-hashes", "--case", "srgb", "--no-times"});
    ASSERT_EQ(held.exit_code, 0) << held.errors;
    const auto json = nlohmann::json::parse(read_file(good));
    EXPECT_EQ(json.at("format"), "claray attestation");
    EXPECT_EQ(json.at("effort"), "quick");
    EXPECT_EQ(json.at("kernels").get<std::string>().size(), 32u);
    for (const char* name : {"platform", "device", "driver", "opencl", "opencl_c", "type"})
        EXPECT_FALSE(json.at(name).get<std::string>().empty()) << name;
    ASSERT_EQ(json.at("first_pictures").size(), 2u);
    for (const auto& picture : json.at("first_pictures")) {
        EXPECT_GT(picture.at("seconds").get<double>(), 0);
        EXPECT_GT(picture.at("compile_seconds").get<double>(), 0) << "kernels were in a cache";
    }
    ASSERT_EQ(json.at("cases").size(), 2u);
    EXPECT_EQ(json.at("cases")[0].at("case"), "tree-hashes");
    EXPECT_GT(json.at("cases")[0].at("facts").size(), 10u);

    const ProcessResult failed = run_claray({"attest", bad, "--case", "tree-hashes", "--limit", "10ms"});
    EXPECT_EQ(failed.exit_code, 3) << failed.errors;
    const ProcessResult page = run_claray({"attest", "--page", good, bad});
    ASSERT_EQ(page.exit_code, 0) << page.errors;
    for (const char* line :
         {"| case | bad | good |", "| `tree-hashes` | **fails** | holds |", "| `srgb` | not run | holds |",
          "| `sort` | not run | not run |", "| bad | `tree-hashes` | killed after 0.01 s without an end |",
          "[good](good.json)", "2 of 2", "0 of 1"})
        EXPECT_NE(page.output.find(line), std::string::npos) << line << "\n" << page.output;
    EXPECT_EQ(run_claray({"attest", "--page", bad, good}).output, page.output) << "the order of the files matters";
}

TEST(AttestCommand, RefusesWhatIsNoWholeAttestation) {
    const fs::path drivers = fs::path(CLARAY_SOURCE_DIR) / "docs/drivers";
    const TemporaryFolder folder;
    const fs::path file = folder / "x.json";
    const std::string whole = read_file(drivers / "pocl-3.1.json");
    const auto refuses = [&](const std::string& text, const std::string& why) {
        write(file, text);
        return failed_with(run_claray({"attest", "--page", file.string()}), 1,
                           "'" + file.string() + "' is no attestation of a device: " + why);
    };
    write(file, whole);
    ASSERT_EQ(run_claray({"attest", "--page", file.string()}).exit_code, 0);
    for (std::size_t part = 0; part < 8; ++part)
        EXPECT_TRUE(refuses(whole.substr(0, whole.size() * part / 8), "it ends too early, after ")) << part;
    EXPECT_TRUE(refuses(whole.substr(0, whole.size() - 2), "it ends too early, after "));
    EXPECT_TRUE(refuses("{]", "its byte 2 is not JSON"));
    for (const char* foreign : {"[]", "7", "{}", R"({"format": 7})"})
        EXPECT_TRUE(refuses(foreign, "claray did not write it"));
    const auto changed = [&](const char* name, const nlohmann::json& value) {
        auto json = nlohmann::json::parse(whole);
        json[name] = value;
        return json.dump();
    };
    EXPECT_TRUE(refuses(changed("version", 2), "it has version 2, and this program reads 1"));
    EXPECT_TRUE(refuses(changed("driver", 7), "it has no valid 'driver'"));
    EXPECT_TRUE(refuses(changed("cases", "all"), "it has no valid 'cases'"));
    EXPECT_TRUE(refuses(changed("cases", {7}), "it has no valid 'case'"));
    EXPECT_TRUE(refuses(changed("cases", {{{"case", "sort"}, {"holds", false}, {"checks", {7}}, {"failures", {7}}}}),
                        "it has no valid 'holds'"));
    EXPECT_TRUE(refuses(changed("first_pictures", {{{"scene", "cornell"}}}), "it has no valid 'seconds'"));
    EXPECT_TRUE(failed_with(run_claray({"attest", "--page", (folder / "none").string()}), 1, "No such file"));
    EXPECT_TRUE(failed_with(run_claray({"attest", "--page"}), 2, "--page needs files"));
    EXPECT_TRUE(failed_with(run_claray({"attest", "--page", "x", "--full"}), 2, "--page runs no case"));
    EXPECT_TRUE(failed_with(run_claray({"attest", "x", "y"}), 2, "more than one file"));
    EXPECT_TRUE(failed_with(run_claray({"attest", "/no/such/folder/x.json", "--case", "sort"}), 1, "/no/such"));
    EXPECT_TRUE(failed_with(run_claray({"attest", "--case", "no-such-case"}), 2, "choose one of"));
}

TEST(AttestCommand, ThePageOfDriversIsWhatTheirFilesGive) {
    const fs::path drivers = fs::path(CLARAY_SOURCE_DIR) / "docs/drivers";
    std::vector<std::string> arguments = {"attest", "--page"};
    for (const auto& entry : fs::directory_iterator(drivers))
        if (entry.path().extension() == ".json") arguments.push_back(entry.path().string());
    ASSERT_GT(arguments.size(), 2u);
    const ProcessResult page = run_claray(arguments);
    ASSERT_EQ(page.exit_code, 0) << page.errors;
    EXPECT_EQ(page.output, read_file(drivers / "README.md"))
        << "build/bin/claray attest --page docs/drivers/*.json > docs/drivers/README.md";
}

}  // namespace
}  // namespace claray::test
