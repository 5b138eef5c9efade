// Machines that lack something: a home, a folder to write to, a stack, a terminal that can do more than write.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Machine : public InFolder {
protected:
    /// By the sh's own `ulimit`, `cd` or `export` before.
    [[nodiscard]] ProcessResult run_after(const std::string& shell, const std::vector<std::string>& arguments,
                                          const Variables& environment = {}) const {
        std::vector<std::string> command = {"sh", "-c", shell + "; exec \"$@\"", "sh"};
        for (const std::string& argument : claray_command(arguments)) command.push_back(argument);
        return run_process(command, environment);
    }
};

/// Two CPU devices of PoCL stand for devices of different drivers, and of one.
TEST_F(Machine, WithDevicesThatRoundDifferently) {
    for (const auto& [devices, differ] : {std::pair("basic pthread", true), std::pair("basic basic", false)}) {
        const ProcessResult result = run_claray(
            {"render", "cornell", "--device", "0,1", "--size", "8x8", "--spp", "1", "-o", path("a.pfm"), "-q"},
            {{"POCL_DEVICES", devices}});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_EQ(result.errors.find("these devices round differently") != std::string::npos, differ) << result.errors;
    }
}

/// /proc refuses even root. PoCL alone finds no device there, or crashes.
TEST_F(Machine, WithoutAHomeThatCanBeWrittenTo) {
    Variables none = {{"HOME", "/proc/nobody"},
                      {"XDG_CACHE_HOME", ""},
                      {"POCL_CACHE_DIR", ""},
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

    EXPECT_TRUE(failed_with(run_claray({"devices"}, {{"POCL_CACHE_DIR", "/proc/nobody"}}), 1,
                            "POCL_CACHE_DIR is '/proc/nobody', which is not writable"));

    const std::vector<DeviceInfo> all = list_devices();
    const bool has_others =
        std::ranges::any_of(all, [](const DeviceInfo& info) { return info.platform != "Portable Computing Language"; });
    if (has_others) GTEST_SKIP() << "the devices of other platforms need no cache";
    none["TMPDIR"] = "/proc/nobody";
    none["XDG_CACHE_HOME"] = "/proc/nobody";
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", path("b.png")}, none), 3, "set POCL_CACHE_DIR"));
}

/// PoCL alone aborts, whatever else can be written to.
TEST_F(Machine, WithAnEmptyCacheVariable) {
    const ProcessResult devices =
        run_claray({"devices"}, {{"POCL_CACHE_DIR", ""}, {"XDG_CACHE_HOME", folder_.path().string()}});
    EXPECT_EQ(devices.exit_code, 0) << devices.errors;
    EXPECT_EQ(devices.errors, "");
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

/// Compilers recurse as deeply as expressions are nested.
TEST_F(Machine, WithASmallStack) {
    fs::copy(fs::path(CLARAY_SOURCE_DIR) / "kernels", folder_ / "kernels", fs::copy_options::recursive);
    fs::copy(fs::path(CLARAY_SOURCE_DIR) / "include", folder_ / "include", fs::copy_options::recursive);
    std::string sum = "a[0]";
    for (int i = 0; i < 1500; ++i) sum += "+a[1]";
    std::ofstream(folder_ / "kernels/bvh/bounds.cl", std::ios::app)
        << "\n// " << folder_.path().string() << ": no cache holds this text\n"
        << "kernel void deep(global volatile uint* a) { a[0] = " << sum << "; }\n";
    const ProcessResult result =
        run_after("ulimit -s 256", {"build", "soup:100", "--builder", "fast", "--layout", "binary", "--repeat", "1"},
                  {{"CLARAY_KERNEL_DIR", path("kernels")}});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
}

}  // namespace
}  // namespace claray::test
