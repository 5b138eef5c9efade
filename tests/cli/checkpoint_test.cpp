// claray render --checkpoint and --resume, and programs that are killed.
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "claray/io.hpp"
#include "host/render/checkpoint/checkpoint.hpp"
#include "tests/cli/claray.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class CheckpointOptions : public InFolder {
protected:
    [[nodiscard]] std::vector<std::string> arguments(const std::string& output,
                                                     const std::vector<std::string>& more = {}) const {
        return with({"render", "cornell", "-o", path(output), "--size", "64x48", "--spp", "8", "-q"}, more);
    }
    [[nodiscard]] ProcessResult render(const std::string& output, const std::vector<std::string>& more = {}) const {
        return run_claray(arguments(output, more));
    }
    [[nodiscard]] Process start(const std::vector<std::string>& all) const {
        return Process(claray_command(all), {{"CLARAY_DEVICE", std::to_string(device().info().index)}});
    }
};

TEST_F(CheckpointOptions, InterruptedAndResumedIsTheSameImage) {
    ASSERT_EQ(render("whole.pfm").exit_code, 0);
    ASSERT_EQ(render("part.pfm", {"--spp", "3", "--checkpoint", path("c"), "--checkpoint-every", "5min"}).exit_code, 0);
    EXPECT_NE(read_file(path("part.pfm")), read_file(path("whole.pfm")));
    const ProcessResult resumed = render("resumed.pfm", {"--resume", path("c"), "--checkpoint", path("c"), "--json"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
    EXPECT_EQ(nlohmann::json::parse(resumed.output).at("spp"), 8);
    EXPECT_EQ(read_file(path("resumed.pfm")), read_file(path("whole.pfm")));
}

TEST_F(CheckpointOptions, WhatDoesNotFitIsOneClearLine) {
    ASSERT_EQ(render("a.png", {"--checkpoint", path("c")}).exit_code, 0);
    EXPECT_TRUE(failed_with(render("a.png", {"--resume", path("c"), "--seed", "1"}), 1, "another seed"));
    EXPECT_TRUE(
        failed_with(render("a.png", {"--resume", path("c"), "--camera", "0,0,1"}), 1, "another scene or camera"));
    EXPECT_TRUE(failed_with(render("a.png", {"--resume", path("none")}), 1, "No such file"));
    EXPECT_TRUE(failed_with(render("a.png", {"--checkpoint", path("no/such/c")}), 1, "no/such/c"));
    EXPECT_TRUE(failed_with(render("a.png", {"--checkpoint", path("c"), "--checkpoint-every", "0s"}), 2, "every"));
    std::string damaged = read_file(path("c"));
    damaged[5000] = char(damaged[5000] ^ 4);
    write_file(path("c"), damaged);
    EXPECT_TRUE(failed_with(render("a.png", {"--resume", path("c")}), 1, "its checksum is wrong"));
    fs::create_symlink("/dev/full", folder_ / "full");
    EXPECT_TRUE(failed_with(render("last.png", {"--checkpoint", path("full")}), 1, "No space left on device"));
    EXPECT_TRUE(fs::exists(folder_ / "last.png")) << "the image is not lost";
}

std::uintmax_t inode_of(const std::string& path) {
    struct stat status = {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

/// Killed while it renders and writes checkpoints all the time: there always is a whole one, which is no older.
TEST_F(CheckpointOptions, KilledAtAnyMoment) {
    ASSERT_EQ(render("part.pfm", {"--spp", "1", "--checkpoint", path("c")}).exit_code, 0);
    const RenderIdentity identity = identity_of(*builtin_scene("cornell"), {.width = 64, .height = 48});
    std::mt19937 random(5);
    std::uint64_t samples = 64 * 48;
    for (int i = 0; i < 30; ++i) {
        const std::uintmax_t before = inode_of(path("c"));
        {
            const Process process =
                start(arguments("never.pfm", {"--spp", "16000000", "--resume", path("c"), "--checkpoint", path("c"),
                                              "--checkpoint-every", "1e-6s"}));
            for (int wait = 0; wait < 4000 && inode_of(path("c")) == before; ++wait) std::this_thread::sleep_for(5ms);
            ASSERT_NE(inode_of(path("c")), 0u);
            ASSERT_EQ(process.errors_so_far(), "");
            std::this_thread::sleep_for(std::chrono::microseconds(random() % 30'000));
        }  // SIGKILL
        const Checkpoint left = read_checkpoint(path("c"), identity, 16'000'000);
        AdaptiveSchedule schedule(64, 48, 16'000'000, 1, false);
        ASSERT_TRUE(schedule.go_to(left.position));
        EXPECT_GE(schedule.samples(), samples);
        samples = schedule.samples();
    }
    EXPECT_GT(samples, 64u * 48);
    EXPECT_FALSE(fs::exists(path("never.pfm")));
    EXPECT_EQ(render("last.pfm", {"--resume", path("c"), "--spp", "16000000", "--time", "0.01"}).exit_code, 0);
}

/// The same for whole files as such, more often: the content is one of the two.
TEST(KilledWriter, LeavesTheOldFileOrTheNew) {
    const TemporaryFolder folder;
    const fs::path file = folder / "f";
    const std::string contents[2] = {std::string(300'000, 'a'), std::string(200'000, 'b')};
    write_file(file, contents[0]);
    std::mt19937 random(6);
    unsigned seen[2] = {0, 0}, left_behind = 0;
    for (int i = 0; i < 100; ++i) {
        const pid_t id = ::fork();
        if (id == 0)
            for (int k = i;; ++k) write_file(file, contents[k % 2]);
        std::this_thread::sleep_for(std::chrono::microseconds(random() % (500u << i % 8)));
        ::kill(id, SIGKILL);
        ::waitpid(id, nullptr, 0);
        const std::string now = read_file(file);
        ASSERT_TRUE(now == contents[0] || now == contents[1]) << now.size() << " bytes";
        ++seen[now == contents[1]];
        for (const auto& entry : fs::directory_iterator(folder.path()))
            if (entry.path() != file) ++left_behind, fs::remove(entry.path());
    }
    EXPECT_GT(seen[0], 0u);
    EXPECT_GT(seen[1], 0u);
    EXPECT_GT(left_behind, 0u) << "none was killed while it wrote";
}

class CheckpointSignals : public CheckpointOptions, public testing::WithParamInterface<int> {};

TEST_P(CheckpointSignals, LeaveACheckpointToGoOnFrom) {
    Process process = start({"render", "cornell", "-o", path("a.pfm"), "--size", "64x48", "--spp", "1000000", "--json",
                             "--checkpoint", path("c"), "--checkpoint-every", "1h"});
    wait_for_samples(process);
    process.send(GetParam());
    const ProcessResult result = process.wait();
    ASSERT_EQ(result.exit_code, 128 + GetParam()) << result.errors;
    EXPECT_EQ(nlohmann::json::parse(result.output).at("interrupted"), true);
    const unsigned spp = nlohmann::json::parse(result.output).at("spp");
    const std::string enough = std::to_string(2 * spp + 64);
    const ProcessResult resumed =
        render("b.pfm", {"--resume", path("c"), "--spp", enough, "--time", "0.001", "--json"});
    ASSERT_EQ(resumed.exit_code, 0) << resumed.errors;
    EXPECT_GE(nlohmann::json::parse(resumed.output).at("spp"), spp);
}

INSTANTIATE_TEST_SUITE_P(All, CheckpointSignals, testing::Values(SIGINT, SIGTERM));

/// Whatever has not begun may be ended at once.
TEST_F(CheckpointOptions, SignalsBeforeTheFirstSampleEndTheProgram) {
    Process process = start({"render", "soup:3000000", "-o", path("a.png"), "--size", "64x48", "-q"});
    for (int i = 0; i < 3000 && !process.handles(SIGINT); ++i) std::this_thread::sleep_for(10ms);
    process.send(SIGINT);
    const ProcessResult result = process.wait();
    EXPECT_EQ(result.exit_code, 128 + SIGINT) << result.errors;
    EXPECT_NE(result.errors.find("interrupted before the first sample"), std::string::npos) << result.errors;
    EXPECT_FALSE(fs::exists(path("a.png")));
}

}  // namespace
}  // namespace claray::test
