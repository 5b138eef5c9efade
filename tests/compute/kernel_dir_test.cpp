// CLARAY_KERNEL_DIR: kernels from files instead of the embedded ones. It is read once a process, hence the child
// processes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

/// Compiles a kernel that includes claray/shared/types.h, in another process.
ProcessResult compile_with(const fs::path& kernel_dir, const fs::path& cache) {
    return run_process({this_program(), "--gtest_filter=Program.StructByValueAndClarayHeaders"},
                       {{"CLARAY_KERNEL_DIR", kernel_dir.string()}, {"CLARAY_CACHE_DIR", cache.string()}});
}

void prepend(const fs::path& file, const std::string& line) {
    const std::string text = read_file(file);
    std::ofstream(file) << line << "\n" << text;
}

class KernelDir : public testing::Test {
protected:
    void SetUp() override {
        fs::copy(fs::path(CLARAY_SOURCE_DIR) / "kernels", folder_ / "kernels", fs::copy_options::recursive);
        fs::copy(fs::path(CLARAY_SOURCE_DIR) / "include", folder_ / "include", fs::copy_options::recursive);
    }
    TemporaryFolder folder_;
};

TEST_F(KernelDir, TheSameFilesGiveTheSameProgram) {
    const ProcessResult result = compile_with(folder_ / "kernels", folder_ / "cache");
    EXPECT_EQ(result.exit_code, 0) << result.output;
}

TEST_F(KernelDir, AnEditedHeaderIsCompiled) {
    ASSERT_EQ(compile_with(folder_ / "kernels", folder_ / "cache").exit_code, 0);
    prepend(folder_ / "include/claray/shared/types.h", "#error edited by the test");
    for (const char* spelling : {"kernels", "kernels/", "kernels/../kernels"}) {
        const ProcessResult result =
            compile_with(folder_ / spelling, folder_ / "cache");  // the old cache must not serve
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_NE(result.output.find("edited by the test"), std::string::npos) << result.output;
    }
}

/// NVIDIA's compiler looks into the folder it runs in, and into its folder include.
TEST_F(KernelDir, FilesThatLieAroundAreNotIncluded) {
    for (const char* around : {"", "include"}) {
        const fs::path file = folder_ / "around" / around / "claray/shared/types.h";
        fs::create_directories(file.parent_path());
        std::ofstream(file) << "#error not this one\n";
    }
    const fs::path before = fs::current_path();
    fs::current_path(folder_ / "around");
    const ProcessResult result = compile_with({}, folder_ / "cache");
    fs::current_path(before);
    EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
}

TEST_F(KernelDir, AnEditedTuningTableIsRead) {
    prepend(folder_ / "kernels/tuning.txt", "this is no row");
    const ProcessResult result = compile_with(folder_ / "kernels", folder_ / "cache");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.output.find("tuning.txt:1: not a tuning row: 'this is no row'"), std::string::npos)
        << result.output;
}

TEST_F(KernelDir, AMissingFolderIsAnError) {
    const ProcessResult result = compile_with(folder_ / "nowhere", folder_ / "cache");
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.output.find("CLARAY_KERNEL_DIR: no folder"), std::string::npos) << result.output;
    const ProcessResult other = compile_with(folder_ / "include", folder_ / "cache");
    EXPECT_NE(other.output.find("CLARAY_KERNEL_DIR: no kernels of claray in"), std::string::npos) << other.output;
}

}  // namespace
}  // namespace claray::test
