// Machines that lack something: a home, a folder to write to, a stack, a terminal that can do more than write.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

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

/// Two CPU devices of PoCL stand for devices of two drivers.
TEST_F(Machine, WithTwoDriversRendersTheImageOfOne) {
    const auto render = [&](const char* device, const std::string& image) {
        const ProcessResult result =
            run_claray({"render", "cornell", "--device", device, "--size", "24x24", "--spp", "4", "-o", image, "-q"},
                       {{"POCL_DEVICES", "basic pthread"}});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_EQ(result.errors, "");
        return read_file(image);
    };
    const std::string one = render("1", path("a.pfm"));
    EXPECT_FALSE(one.empty());
    EXPECT_EQ(render("0,1", path("b.pfm")), one);
}

/// Compiles few kernels.
const std::vector<std::string> small_build = {"build",    "soup:10", "--builder", "fast",
                                              "--layout", "binary",  "--repeat",  "1"};

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

/// PoCL passes paths to its compiler without quotes.
TEST_F(Machine, WithBlanksInItsPaths) {
    const std::string blank = path("a b"), quoted = path("it's \"here\"");
    fs::create_directory(blank), fs::create_directory(quoted);
    const Variables home = {{"HOME", blank}, {"XDG_CACHE_HOME", ""}, {"POCL_CACHE_DIR", ""}, {"CLARAY_CACHE_DIR", ""}};
    const Variables chosen = {
        {"POCL_CACHE_DIR", quoted}, {"XDG_CACHE_HOME", blank}, {"CLARAY_CACHE_DIR", blank}, {"TMPDIR", blank}};
    for (const Variables& variables : {home, chosen}) {
        const ProcessResult build = run_claray(small_build, variables);
        EXPECT_EQ(build.exit_code, 0) << build.errors;
    }
}

/// PoCL alone aborts.
TEST_F(Machine, WithDamagedFilesOfPocl) {
    const Variables variables = {{"POCL_CACHE_DIR", path("pocl")}, {"CLARAY_CACHE_DIR", path("claray")}};
    ASSERT_EQ(run_claray(small_build, variables).exit_code, 0);
    for (const bool keeps_own : {true, false}) {
        if (!keeps_own) fs::remove_all(path("claray"));
        for (const auto& entry : fs::recursive_directory_iterator(path("pocl")))
            if (entry.is_regular_file()) fs::resize_file(entry, entry.file_size() / 2);
        const ProcessResult again = run_claray(small_build, variables);
        EXPECT_EQ(again.exit_code, 0) << again.errors;
    }
    EXPECT_TRUE(fs::is_empty(path("pocl"))) << "each process removes what it wrote";
}

/// On a file system of its own, which takes a user namespace.
TEST_F(Machine, WithAFullDisk) {
    fs::create_directory(path("full"));
    const auto run_on_full_disk = [&](const std::vector<std::string>& command, const Variables& variables) {
        std::vector<std::string> all = {
            "unshare", "-rm", "sh", "-c", "mount -t tmpfs -o size=64k none '" + path("full") + "' && exec \"$@\"",
            "sh"};
        all.insert(all.end(), command.begin(), command.end());
        return run_process(all, variables);
    };
    if (run_on_full_disk({"true"}, {}).exit_code != 0) GTEST_SKIP() << "no file systems can be mounted here";
    const std::string full = path("full");
    const ProcessResult result = run_on_full_disk(claray_command(small_build), {{"HOME", full},
                                                                                {"XDG_CACHE_HOME", full},
                                                                                {"CLARAY_CACHE_DIR", full + "/c"},
                                                                                {"POCL_CACHE_DIR", full},
                                                                                {"XDG_STATE_HOME", full},
                                                                                {"TMPDIR", folder_.path().string()}});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.errors.find("compiled kernels cannot be cached"), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("No space left on device"), std::string::npos) << result.errors;
}

/// A driver in C, by the compiler of this machine.
class Drivers : public Machine {
protected:
    void SetUp() override {
        if (std::system("cc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no C compiler";
        fs::create_directory(path("vendors"));
        const char* own = std::getenv("OCL_ICD_VENDORS");
        const fs::path vendors = own != nullptr ? own : "/etc/OpenCL/vendors";
        for (const auto& entry : fs::directory_iterator(vendors))
            if (entry.path().extension() == ".icd")
                fs::copy_file(entry.path(), path("vendors") / entry.path().filename());
    }
    void install(const std::string& name, const std::string& source) const {
        std::ofstream(path(name + ".c")) << source;
        const std::string library = path(name + ".so");
        ASSERT_EQ(std::system(("cc -shared -fPIC -o '" + library + "' '" + path(name + ".c") + "'").c_str()), 0);
        std::ofstream(path("vendors/" + name + ".icd")) << library << '\n';
    }
    [[nodiscard]] ProcessResult run(const std::vector<std::string>& arguments) const {
        return run_claray(arguments, {{"OCL_ICD_VENDORS", path("vendors")}, {"CLARAY_CACHE_DIR", path("cache")}});
    }
};

TEST_F(Drivers, ThatCrashAreLeftOutAndNamed) {
    install("crash",
            "#include <stdlib.h>\nvoid* clGetExtensionFunctionAddress(const char* n) { abort(); return 0; }\n");
    for (int i = 0; i < 2; ++i) {
        const ProcessResult devices = run({"devices"});
        EXPECT_EQ(devices.exit_code, 0) << devices.errors;
        EXPECT_NE(devices.output.find(device().info().name), std::string::npos) << "the others are used";
        EXPECT_NE(devices.errors.find("crash.so' of '" + path("vendors/crash.icd") + "' crashes"), std::string::npos)
            << devices.errors;
    }
    const ProcessResult build = run(small_build);
    EXPECT_EQ(build.exit_code, 0);
    EXPECT_NE(build.errors.find("crashes when it lists its devices"), std::string::npos) << build.errors;
}

TEST_F(Drivers, ThatCannotBeLoadedAreNamed) {
    std::ofstream(path("vendors/gone.icd")) << "libgone-claray-test.so\n";
    const ProcessResult devices = run({"devices"});
    EXPECT_EQ(devices.exit_code, 0) << devices.errors;
    EXPECT_NE(devices.errors.find("libgone-claray-test.so"), std::string::npos) << devices.errors;
    EXPECT_TRUE(failed_with(run({"build", "soup:10", "--device", "no such device"}), 2, "libgone-claray-test.so"));
    for (const auto& entry : fs::directory_iterator(path("vendors")))
        if (entry.path().filename() != "gone.icd") fs::remove(entry);
    EXPECT_TRUE(failed_with(run({"devices"}), 3, "gone.icd' cannot be loaded"));
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
