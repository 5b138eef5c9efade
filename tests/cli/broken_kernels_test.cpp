// A kernel that does not compile: exit code 3, a line that names a file, and in it all that a report needs.
#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

TEST(BrokenKernels, AreReportedInAFile) {
    const TemporaryFolder folder;
    fs::copy(fs::path(CLARAY_SOURCE_DIR) / "kernels", folder / "kernels", fs::copy_options::recursive);
    fs::copy(fs::path(CLARAY_SOURCE_DIR) / "include", folder / "include", fs::copy_options::recursive);
    const std::vector<std::string> render = {
        "render", "cornell", "-o", (folder / "a.png").string(), "--size",       "8x8",
        "--spp",  "1",       "-q", "--wait-for-kernels",        "--checkpoint", (folder / "c").string()};
    const Variables environment = {{"CLARAY_KERNEL_DIR", (folder / "kernels").string()},
                                   {"XDG_STATE_HOME", (folder / "state").string()}};
    ASSERT_EQ(run_claray(render).exit_code, 0);
    const std::string checkpoint = read_file(folder / "c"), image = read_file(folder / "a.png");

    std::ofstream(folder / "kernels/render/shade_surface.cl", std::ios::app) << "\n#error this is no kernel\n";
    const ProcessResult result = run_claray(render, environment);
    EXPECT_EQ(result.exit_code, 3);
    // Some drivers' compilers print how many errors there were on a line of their own before.
    EXPECT_NE(result.errors.find("claray: error: cannot compile the kernel render/shade_surface.cl"), std::string::npos)
        << result.errors;
    EXPECT_NE(result.errors.find("no kernel"), std::string::npos) << "the compiler's reason: " << result.errors;
    const std::size_t at = result.errors.find("the log is in ");
    ASSERT_NE(at, std::string::npos) << result.errors;
    const std::string path = result.errors.substr(at + 14, result.errors.size() - at - 15);
    EXPECT_EQ(fs::path(path).parent_path(), folder / "state/claray");
    struct stat log_file = {};
    ASSERT_EQ(::lstat(path.c_str(), &log_file), 0);
    EXPECT_EQ(log_file.st_mode & 0777, 0600u) << "for nobody else";
    EXPECT_EQ(log_file.st_nlink, 1u);
    EXPECT_LE(std::find(result.errors.begin(), result.errors.end(), '\n') - result.errors.begin(), 300);
    EXPECT_NE(run_claray(render, environment).errors.find("the log is in "), std::string::npos);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "state/claray"), fs::directory_iterator()), 2)
        << "each has a name of its own";
    const std::string log = read_file(path);
    for (const char* words : {"device: ", "platform: ", "driver: ", "version: ", "kernel sources: ", "-cl-std=CL1.2",
                              "render/shade_surface.cl", "log:\n", "no kernel"})
        EXPECT_NE(log.find(words), std::string::npos) << words << " in " << log;
    EXPECT_EQ(read_file(folder / "c"), checkpoint);
    EXPECT_EQ(read_file(folder / "a.png"), image);
}

}  // namespace
}  // namespace claray::test
