// Where output goes: pipes, links, devices, and two names of one file. Nothing is lost, and nothing is written twice.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "tests/cli/claray.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Outputs : public InFolder {
protected:
    [[nodiscard]] static std::vector<std::string> small(const std::string& output,
                                                        const std::vector<std::string>& more = {}) {
        return with({"render", "cornell", "-o", output, "--size", "16x16", "--spp", "1", "--quiet"}, more);
    }
    void refuse(const std::string& output, const std::vector<std::string>& more, const std::string& words) const {
        EXPECT_TRUE(failed_with(run_claray(small(output, more)), 2, words)) << words;
    }
    [[nodiscard]] bool is_png(const std::string& name) const { return read_file(path(name)).starts_with("\x89PNG"); }
    /// The program's standard output goes to a file.
    [[nodiscard]] ProcessResult run_into(const std::string& file, const std::vector<std::string>& arguments) const {
        std::vector<std::string> command = {"sh", "-c", "file=$1; shift; exec \"$@\" > \"$file\"", "sh", file};
        for (const std::string& argument : claray_command(arguments)) command.push_back(argument);
        return run_process(command);
    }
};

TEST_F(Outputs, APipeIsOpenedOnce) {
    ASSERT_EQ(::mkfifo(path("pipe.png").c_str(), 0600), 0);
    std::string read;
    std::thread reader([&] { read = read_file(path("pipe.png")); });  // until it is closed for the first time
    const ProcessResult result = run_claray(small(path("pipe.png")));
    reader.join();
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(read.starts_with("\x89PNG") && read.find("IEND") != std::string::npos) << read.size();
    EXPECT_TRUE(fs::is_fifo(path("pipe.png")));
}

TEST_F(Outputs, TwoNamesOfOneFileAreRefused) {
    fs::create_directory(path("sub"));
    fs::create_directory_symlink("sub", path("way"));
    std::ofstream(path("there.json")) << "{}";
    fs::create_symlink("there.json", path("link.json"));
    fs::create_symlink("a.png", path("dangling"));
    const std::string a = path("a.png");
    refuse(a, {"--trace", path("sub/../a.png")}, "--output and --trace are the same file");
    refuse(a, {"--trace", path("dangling")}, "--output and --trace are the same file");
    refuse(path("sub/b.png"), {"--trace", path("way/b.png")}, "--output and --trace are the same file");
    refuse(a, {"--trace", path("link.json"), "--checkpoint", path("there.json")},
           "--checkpoint and --trace are the same file");
    refuse(a, {"--trace", path("a.depth.png"), "--aov", "depth"}, "--trace and --aov depth are the same file");
    refuse(path("a.depth.pfm"), {"--aov", "normal", "--checkpoint", path("a.depth.normal.pfm")},
           "--aov normal are the same file");
    EXPECT_TRUE(failed_with(run_claray({"accuracy", "cornell", "--csv", a, "--html", path("./a.png")}), 2,
                            "--csv and --html are the same file"));
    EXPECT_TRUE(failed_with(run_claray({"verify", "--json", a, "--html", path("./a.png")}), 2,
                            "--json and --html are the same file"));
    EXPECT_FALSE(fs::exists(a));
}

TEST_F(Outputs, WhatIsReadIsNotReplaced) {
    std::ofstream(path("s.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::create_symlink("s.obj", path("link"));
    const std::string before = read_file(path("s.obj"));
    const ProcessResult result = run_claray(
        {"render", path("s.obj"), "-o", path("a.png"), "--trace", path("link"), "--size", "8x8", "--spp", "1"});
    EXPECT_TRUE(failed_with(result, 2, "--trace and the scene are the same file"));
    EXPECT_EQ(read_file(path("s.obj")), before);
}

TEST_F(Outputs, DevicesTakeMoreThanOne) {
    EXPECT_EQ(run_claray(small(path("a.png"), {"--trace", "/dev/null", "--checkpoint", "/dev/null"})).exit_code, 0);
}

TEST_F(Outputs, ADanglingLinkIsFollowed) {
    fs::create_directory(path("far"));
    fs::create_symlink("far/b.png", path("a.png"));
    EXPECT_EQ(run_claray(small(path("a.png"))).exit_code, 0);
    EXPECT_TRUE(fs::is_symlink(path("a.png")) && is_png("far/b.png"));
    fs::create_symlink("nowhere/b.png", path("c.png"));
    EXPECT_TRUE(
        failed_with(run_claray(small(path("c.png"))), 1, "c.png': No such file or directory; create the folder"));
    fs::create_symlink("d.png", path("d.png"));
    EXPECT_TRUE(failed_with(run_claray(small(path("d.png"))), 1, "d.png': Too many levels of symbolic links"));
}

TEST_F(Outputs, StandardOutputKeepsWhatWasPrinted) {
    const ProcessResult result = run_into(path("log"), small(path("a.png"), {"--trace", "/dev/stdout"}));
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    const std::string log = read_file(path("log"));
    EXPECT_NE(log.find("traceEvents"), std::string::npos);
    EXPECT_NE(log.find("a.png: 16x16"), std::string::npos) << "printed after the trace";
    EXPECT_TRUE(failed_with(run_into(path("b.png"), small(path("b.png"))), 2,
                            "--output and standard output are the same file"));
}

TEST_F(Outputs, AnImageOnStandardOutputIsAlone) {
    for (const char* format : {"png", "jpg", "hdr", "pfm"}) {
        const std::string file = path(std::string("a.") + format);
        const ProcessResult piped = run_claray(small("-", {"--format", format}));
        ASSERT_EQ(piped.exit_code, 0) << piped.errors;
        EXPECT_EQ(run_claray(small(file)).exit_code, 0);
        EXPECT_TRUE(piped.output == read_file(file)) << format << ": " << piped.output.size() << " bytes";
        EXPECT_EQ(piped.errors, "");
    }
    EXPECT_TRUE(run_claray(small("-")).output == read_file(path("a.png"))) << "without --format";
    EXPECT_TRUE(run_claray(small("-", {"--png-bits", "16"})).output.substr(24, 1) == "\x10") << "bits, in the header";
    refuse("-", {"--json"}, "--json: standard output has the picture");
    refuse("-", {"--stats"}, "--stats: standard output has the picture");
    refuse("-", {"--fps", "5"}, "--fps: standard output has the picture");
    refuse("-", {"--aov", "depth"},
           "--aov depth: standard output has no place for it; write files, or add --format exr");
    refuse("-", {"--format", "bmp"}, "--format: unknown name 'bmp'");
}

TEST_F(Outputs, EncodingsAreOptions) {
    const auto size = [&](const std::string& name, const std::vector<std::string>& more) {
        EXPECT_EQ(run_claray(small(path(name), with({"--size", "64x64"}, more))).exit_code, 0);
        return fs::file_size(path(name));
    };
    EXPECT_LT(size("a.jpg", {"--quality", "20"}), size("b.jpg", {}));
    EXPECT_LT(size("b.jpg", {}), size("c.jpg", {"--quality", "100"}));
    EXPECT_LT(size("a.png", {}), size("b.png", {"--png-bits", "16"}));
    refuse(path("a.jpg"), {"--quality", "0"}, "--quality: '0' is not a whole number in 1..100, or lossless");
    refuse(path("a.jpg"), {"--quality", "lossless"}, "a JPEG loses some of each image; write a .webp or a .png");
    refuse(path("a.png"), {"--png-bits", "12"}, "--png-bits: unknown name '12'; choose 8 or 16");
    const auto warns = [&](const std::string& name, const std::vector<std::string>& more, const char* words) {
        const ProcessResult result = run_claray(small(path(name), more));
        EXPECT_NE(result.errors.find(words), std::string::npos) << result.errors;
        EXPECT_EQ(result.exit_code, 0);
    };
    warns("a.jpg", {"--png-bits", "16"}, "warning: --png-bits applies to .png only: ");
    warns("a.png", {"--quality", "50"}, "warning: --quality applies to .jpg and .webp only: ");
}

TEST_F(Outputs, OneFullDiskLosesNothingElse) {
    const ProcessResult result =
        run_claray(small(path("a.png"), {"--aov", "depth", "--trace", "/dev/full", "--checkpoint", path("c")}));
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(result.errors.starts_with("claray: error: cannot write '/dev/full': No space left on device; free"))
        << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_TRUE(is_png("a.png") && is_png("a.depth.png") && fs::exists(path("a.depth.pfm")) && fs::exists(path("c")));
    EXPECT_NE(result.output.find("a.png: 16x16"), std::string::npos);
    const ProcessResult printed = run_into("/dev/full", small(path("b.png")));
    EXPECT_TRUE(failed_with(printed, 1, "cannot write to standard output: No space left on device"));
    EXPECT_TRUE(is_png("b.png"));
    EXPECT_TRUE(failed_with(run_claray(small("/dev/full")), 2, "unknown image format"));
    fs::create_symlink("/dev/full", path("full.png"));
    const ProcessResult lost = run_claray(small(path("full.png")));
    EXPECT_TRUE(failed_with(lost, 1, "full.png': No space left on device"));
    EXPECT_EQ(lost.output, "") << "no success beside it";
    EXPECT_TRUE(failed_with(run_claray(small(path("c.png"), {"--trace", path("")})), 1,
                            "Is a directory; give the name of a file"));
}

}  // namespace
}  // namespace claray::test
