// Bad input: one line that says what, where and what to do; an exit code by kind; no partial file.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class BadInput : public InFolder {
protected:
    [[nodiscard]] std::string file(const std::string& name, const std::string& content) const {
        std::ofstream(path(name)) << content;
        return path(name);
    }
    [[nodiscard]] std::vector<std::string> arguments(const std::string& scene,
                                                     const std::vector<std::string>& more = {}) const {
        return with({"render", scene, "-o", path("out.png"), "--size", "16x16", "--spp", "1", "--quiet"}, more);
    }
    [[nodiscard]] ProcessResult render(const std::string& scene, const std::vector<std::string>& more = {}) const {
        return run_claray(arguments(scene, more));
    }
    /// Neither an image nor a temporary file beside it.
    [[nodiscard]] bool nothing_written() const {
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            if (entry.path().filename().string().starts_with("out")) return false;
        return true;
    }
    void TearDown() override { EXPECT_TRUE(nothing_written()); }
};

TEST_F(BadInput, MissingFile) {
    EXPECT_TRUE(failed_with(render(path("missing.obj")), 1, "missing.obj': No such file or directory"));
}
TEST_F(BadInput, FolderAsScene) {
    EXPECT_TRUE(failed_with(render(folder_.path().string()), 2, folder_.path().string()));
}
TEST_F(BadInput, UnknownScene) {
    EXPECT_TRUE(
        failed_with(render("no-such-scene"), 2, "unknown scene 'no-such-scene'; give the path of a scene file"));
}
TEST_F(BadInput, BadTriangleCount) { EXPECT_TRUE(failed_with(render("soup:many"), 2, "soup:N")); }

TEST_F(BadInput, ImageSizes) {
    for (const char* size : {"0x16", "16x0", "16", "16x", "x16", "-1x16", "16x16x16", "16.5x16", "99999x16", ""})
        EXPECT_TRUE(failed_with(render("cornell", {"--size", size}), 2, "--size")) << size;
}
TEST_F(BadInput, CameraVectors) {
    for (const char* vector : {"1,2", "1,2,3,4", "a,b,c", "1,2,nan", "1,,3", "inf,0,0"})
        EXPECT_TRUE(failed_with(render("cornell", {"--camera", vector}), 2, "--camera")) << vector;
    EXPECT_TRUE(failed_with(render("cornell", {"--camera", "1,1,1", "--look-at", "1,1,1"}), 2, "camera"));
    EXPECT_TRUE(failed_with(render("cornell", {"--camera", "0,5,0", "--look-at", "0,0,0", "--up", "0,1,0"}), 2, "up"));
    for (const char* angle : {"0", "180", "-5", "wide"}) {
        const ProcessResult result = render("cornell", {"--fov", angle});
        EXPECT_EQ(result.exit_code, 2) << angle << result.errors;
    }
}
TEST_F(BadInput, OptionValues) {
    const std::vector<std::vector<std::string>> all = {
        {"--spp", "0"},   {"--spp", "many"},       {"--max-depth", "0"}, {"--time", "-1"},
        {"--noise", "0"}, {"--time", "0"},         {"--time", "0s"},     {"--aov", "beauty"},
        {"--seed", "-1"}, {"--morton-bits", "32"}, {"--layout", "deep"}, {"--tone-map", "warm"}};
    for (const std::vector<std::string>& option : all)
        EXPECT_TRUE(failed_with(render("cornell", option), 2, option[0])) << option[0] << ' ' << option[1];
}
TEST_F(BadInput, UnknownDevice) {
    EXPECT_TRUE(
        failed_with(render("cornell", {"--device", "abacus"}), 2, "no device matches 'abacus'; available: 0 = "));
    EXPECT_TRUE(
        failed_with(run_claray(arguments("cornell"), {{"CLARAY_DEVICE", "abacus"}}), 2, "no device matches 'abacus'"));
}

TEST_F(BadInput, OutputsAreCheckedBeforeTheSceneIsLoaded) {
    EXPECT_TRUE(
        failed_with(run_claray({"render", path("missing.obj"), "-o", path("no/such/out.png")}), 1, "no/such/out.png"));
    EXPECT_TRUE(failed_with(run_claray({"render", path("missing.obj"), "-o", path("out.gif")}), 2, ".gif"));
    EXPECT_TRUE(failed_with(run_claray({"render", path("missing.obj"), "-o", folder_.path().string()}), 2, ""));
    EXPECT_TRUE(failed_with(render(path("missing.obj"), {"--trace", path("no/such/trace.json")}), 1, "trace.json"));
}
TEST_F(BadInput, ReadOnlyFolder) {
    // /proc refuses even root.
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", "/proc/out.png"}), 1, "/proc/out.png"));
    if (::geteuid() == 0) return;
    fs::create_directory(folder_ / "locked");
    ::chmod(path("locked").c_str(), 0555);
    EXPECT_TRUE(failed_with(run_claray({"render", "cornell", "-o", path("locked/out.png")}), 1, "Permission denied"));
    ::chmod(path("locked").c_str(), 0755);
}

TEST_F(BadInput, FullDisk) {
    fs::create_symlink("/dev/full", folder_ / "full.png");
    const ProcessResult full =
        run_claray({"render", "cornell", "-o", path("full.png"), "--size", "16x16", "--spp", "1", "-q"});
    EXPECT_TRUE(failed_with(full, 1, "No space left on device; free some space"));

    // A limit on file sizes ends an ordinary file halfway, as a full disk does, and the half must not stay. The
    // driver's files are smaller than the limit of 4 MiB, or 8 where the shell counts in KiB.
    const std::vector<std::string> whole = {"render",    "cornell", "-o", path("out.pfm"), "--size",
                                            "1024x1024", "--spp",   "1",  "--quiet",       "--wait-for-kernels"};
    ASSERT_EQ(run_claray(whole).exit_code, 0);
    fs::remove(path("out.pfm"));
    std::string command = "trap '' XFSZ; ulimit -f 8192; exec \"$@\"";
    std::vector<std::string> limited = {"sh", "-c", command, "sh"};
    for (const std::string& argument : claray_command(whole)) limited.push_back(argument);
    EXPECT_TRUE(
        failed_with(run_process(limited, {{"CLARAY_DEVICE", std::to_string(device().info().index)}}), 1, "out.pfm"));
}

TEST_F(BadInput, ASceneOfWhichNothingCanBeSeen) {
    const std::string flat = file("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv nan 0 0\nf 1 1 2\nf 1 2 3\nf 1 2 4\n");
    const ProcessResult result = render(flat, {"--sky", "1"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.errors.find("flat.obj' has no visible triangle: all 3 are without area"), std::string::npos)
        << result.errors;
    EXPECT_TRUE(failed_with(render(file("a.obj", std::string(triangle) + "f 1 2 x\n")), 1, "a.obj' line 4: 'x'"));
}

class Mended : public BadInput {
protected:
    void TearDown() override { EXPECT_TRUE(fs::exists(folder_ / "out.png")); }
};

TEST_F(Mended, MissingMtlIsAWarning) {
    const ProcessResult result = render(file("a.obj", "mtllib missing.mtl\n" + std::string(triangle) + "f 1 2 3\n"));
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(result.errors.starts_with("claray: warning: ")) << result.errors;
    EXPECT_NE(result.errors.find("missing.mtl"), std::string::npos) << result.errors;
}

TEST_F(Mended, AProgramCacheThatCannotBeWrittenIsAWarning) {
    const ProcessResult result = run_claray(arguments("cornell"), {{"CLARAY_CACHE_DIR", "/proc/kernels"}});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(
        result.errors.starts_with("claray: warning: compiled kernels cannot be cached: "
                                  "cannot create the folder '/proc/kernels': "))
        << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
}

TEST_F(Mended, NanVertexIsLeftOutAndCounted) {
    const ProcessResult result =
        render(file("a.obj", std::string(triangle) + "v nan 0 1\nf 1 2 3\nf 1 2 4\n"), {"--stats"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("1 triangles (1 culled)"), std::string::npos) << result.output;
}

}  // namespace
}  // namespace claray::test
