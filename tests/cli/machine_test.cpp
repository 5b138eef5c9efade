// Machines that lack something: a home, a folder to write to, a stack, a terminal that can do more than write.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Machine : public testing::Test {
protected:
    [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// By the sh's own `ulimit`, `cd` or `export` before.
    [[nodiscard]] ProcessResult run_after(const std::string& shell, const std::vector<std::string>& arguments,
                                          const Environment& environment = {}) const {
        std::vector<std::string> command = {"sh", "-c", shell + "; exec \"$@\"", "sh"};
        for (const std::string& argument : claray_command(arguments)) command.push_back(argument);
        return run_process(command, environment);
    }
    const std::vector<std::string> render_ = {"render", "cornell", "-o", path("a.png"), "--size",
                                              "16x16",  "--spp",   "1",  "--quiet",     "--wait-for-kernels"};
    TemporaryFolder folder_;
};

/// /proc refuses even root. PoCL alone finds no device there, or crashes.
TEST_F(Machine, WithoutAHomeThatCanBeWrittenTo) {
    Environment none = {{"HOME", "/proc/nobody"},
                        {"XDG_CACHE_HOME", ""},
                        {"CLARAY_CACHE_DIR", "/proc/nobody"},
                        {"TMPDIR", folder_.path().string()}};
    const ProcessResult devices = run_claray({"devices"}, none);
    EXPECT_EQ(devices.exit_code, 0) << devices.errors;
    EXPECT_EQ(devices.errors, "");
    const std::string own = path("claray-" + std::to_string(::geteuid()));
    struct stat found = {};
    ASSERT_EQ(::lstat(own.c_str(), &found), 0) << "its folder";
    EXPECT_EQ(found.st_mode & 0777, 0700u);
    EXPECT_TRUE(fs::is_directory(own + "/pocl"));

    const ProcessResult unset =
        run_after("unset HOME XDG_CACHE_HOME", {"devices"}, {{"TMPDIR", folder_.path().string()}});
    EXPECT_EQ(unset.exit_code, 0) << unset.errors;

    none["TMPDIR"] = "/proc/nobody";
    none["XDG_CACHE_HOME"] = "/proc/nobody";
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", path("b.png")}, none), 3, "set POCL_CACHE_DIR"));
    EXPECT_TRUE(failed_with(run_claray({"devices"}, {{"POCL_CACHE_DIR", "/proc/nobody"}}), 1,
                            "POCL_CACHE_DIR is '/proc/nobody', which cannot be written to"));
}

/// Another user's folder of that name, or a link, is not used.
TEST_F(Machine, AFolderOfOthersIsNotTrusted) {
    fs::create_directory(path("elsewhere"));
    fs::create_directory_symlink("elsewhere", path("claray-" + std::to_string(::geteuid())));
    const ProcessResult devices = run_claray({"devices"}, {{"HOME", "/proc/nobody"},
                                                           {"XDG_CACHE_HOME", ""},
                                                           {"CLARAY_CACHE_DIR", "/proc/nobody"},
                                                           {"TMPDIR", folder_.path().string()}});
    EXPECT_EQ(devices.exit_code, 0) << devices.errors;
    EXPECT_TRUE(fs::is_empty(path("elsewhere")));
}

/// Everything is compiled anew, which is what takes most of the stack.
TEST_F(Machine, WithASmallStack) {
    const ProcessResult result =
        run_after("ulimit -s 1024", render_, {{"CLARAY_CACHE_DIR", path("cache")}, {"POCL_CACHE_DIR", path("pocl")}});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(fs::exists(path("a.png")));
}

}  // namespace
}  // namespace claray::test
