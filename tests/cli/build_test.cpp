// claray build: what it prints, what it saves, what it refuses.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

#include "host/base/hash.hpp"
#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

TEST(BuildCommand, PrintsCostAndQuality) {
    const ProcessResult result = run_claray({"build", "soup:500", "--repeat", "2", "--builder", "balanced"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    for (const char* words : {"500 triangles (0 culled)", "SAH cost", "MB, valid", "hash",
                              "to build, including scratch", "Mtri/s", "  build_"})
        EXPECT_NE(result.output.find(words), std::string::npos) << words << "\n" << result.output;
}

TEST(BuildCommand, SavesWhatItLoadsAgain) {
    const TemporaryFolder folder;
    const std::string path = (folder / "tree.cbvh").string();
    const ProcessResult built = run_claray({"build", "soup:500", "--repeat", "1", "-o", path, "--json"});
    ASSERT_EQ(built.exit_code, 0) << built.errors;
    const ProcessResult loaded = run_claray({"build", path, "--layout", "binary", "--json"});
    ASSERT_EQ(loaded.exit_code, 0) << loaded.errors;
    const auto before = nlohmann::json::parse(built.output), after = nlohmann::json::parse(loaded.output);
    for (const char* fact : {"triangles", "culled", "height", "sah_cost", "hash", "valid"})
        EXPECT_EQ(before.at(fact), after.at(fact)) << fact;
    EXPECT_EQ(after.at("layout"), "binary");
    EXPECT_TRUE(before.contains("build"));
    EXPECT_FALSE(after.contains("build"));
    EXPECT_NE(run_claray({"build", path}).output.find("loaded"), std::string::npos);

    // A box that does not contain its triangles, with right checksums.
    constexpr std::size_t header = 168, boxes = 48;  // docs/formats.md
    std::string forged = read_file(folder / "tree.cbvh");
    std::fill_n(forged.begin() + header, boxes, '\0');
    const Digest digest = digest_of(forged.data() + header, forged.size() - header - sizeof digest);
    std::copy(digest.begin(), digest.end(), forged.end() - sizeof digest);
    const std::string forged_path = folder.file("forged.cbvh", forged).string();
    const ProcessResult refused = run_claray({"build", forged_path, "-o", (folder / "copy.cbvh").string()});
    EXPECT_TRUE(failed_with(refused, 1, "forged.cbvh' is damaged: some of its boxes do not contain their triangles"));
    EXPECT_FALSE(std::filesystem::exists(folder / "copy.cbvh"));

    std::ofstream(path, std::ios::binary | std::ios::in).seekp(1000) << "damage";
    EXPECT_TRUE(failed_with(run_claray({"build", path}), 1, "tree.cbvh': the file is damaged"));
}

TEST(BuildCommand, BadInput) {
    EXPECT_TRUE(failed_with(run_claray({"build"}), 2, "scene"));
    EXPECT_TRUE(failed_with(run_claray({"build", "missing.cbvh"}), 1, "missing.cbvh"));
    EXPECT_TRUE(failed_with(run_claray({"build", "soup:5", "-o", "/no/such/folder/a.cbvh"}), 1, "/no/such/folder"));
    EXPECT_TRUE(failed_with(run_claray({"build", "soup:5", "--builder", "best"}), 2, "best"));
}

}  // namespace
}  // namespace claray::test
