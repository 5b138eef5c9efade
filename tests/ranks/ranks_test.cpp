// `claray render` under mpirun, on this machine.
#include <gtest/gtest.h>

#include <signal.h>

#include <fstream>
#include <optional>

#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Ranks : public testing::Test {
protected:
    using Words = std::vector<std::string>;

    [[nodiscard]] Words render(const Words& more) const {
        Words words = {CLARAY_PROGRAM, "render", "cornell", "--device", "cpu", "--size", "61x43", "-q"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    /// `mpirun` of several programs, each with its number of ranks and its words.
    [[nodiscard]] static Words mpirun(const std::vector<std::pair<int, Words>>& programs, const Words& options = {}) {
        Words words = {"mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none"};
        words.insert(words.end(), options.begin(), options.end());
        for (const auto& [count, program] : programs) {
            if (&program != &programs.front().second) words.emplace_back(":");
            words.insert(words.end(), {"-n", std::to_string(count)});
            words.insert(words.end(), program.begin(), program.end());
        }
        return words;
    }
    [[nodiscard]] ProcessResult alone(const Words& more) const { return run_process(render(more)); }
    [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// The image, or what was said instead.
    [[nodiscard]] std::string image(const std::string& name, const ProcessResult& result) const {
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return fs::exists(path(name)) ? read_file(path(name)) : result.errors;
    }

    TemporaryFolder folder_;
    const Words recovery_ = {"--mca", "orte_enable_recovery", "1"};  // a rank that dies does not end the others
};

/// The process of a rank that mpirun started with `word` on its command line.
std::optional<pid_t> process_of(const std::string& word, int rank) {
    const std::string number = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
        const pid_t id = std::atoi(entry.path().filename().c_str());
        if (id <= 0) continue;
        const std::string command = read_file(entry.path() / "cmdline"),
                          environment = read_file(entry.path() / "environ");
        if (command.find(word) != std::string::npos && (environment + '\0').find(number + '\0') != std::string::npos)
            return id;
    }
    return std::nullopt;
}

/// The number of samples in "a.pfm: 61x43, 400 spp in 0.30 s".
unsigned samples_in(const std::string& output) {
    const std::size_t end = output.find(" spp in");
    if (end == std::string::npos) return 0;
    return unsigned(std::stoul(output.substr(output.rfind(' ', end - 1) + 1)));
}

std::size_t count(const std::string& text, const std::string& words) {
    std::size_t times = 0;
    for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; at += words.size()) ++times;
    return times;
}

/// `words` in the only line of claray.
testing::AssertionResult says(const ProcessResult& result, int exit_code, const std::string& words) {
    const std::string mark = "claray: error: ";
    const std::size_t first = result.errors.find(mark);
    if (result.exit_code != exit_code || first == std::string::npos ||
        result.errors.find(mark, first + 1) != std::string::npos || result.errors.find(words) == std::string::npos)
        return testing::AssertionFailure() << "exit code " << result.exit_code << ": " << result.errors;
    return testing::AssertionSuccess();
}

TEST_F(Ranks, MakeTheImageOfOneBitForBit) {
    const std::string expected = image("1.pfm", alone({"--spp", "40", "-o", path("1.pfm")}));
    const ProcessResult result = run_process(mpirun({{3, render({"--spp", "40", "-o", path("3.pfm")})}}));
    EXPECT_TRUE(image("3.pfm", result) == expected);
    EXPECT_NE(result.output.find("rank 2"), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("spp in"), result.output.rfind("spp in")) << "rank 0 alone reports";
}

TEST_F(Ranks, GuidePathsAsOne) {
    const auto words = [&](const char* name) { return Words{"--size", "160x160", "--spp", "40", "-o", path(name)}; };
    const std::string expected = image("1.pfm", alone(words("1.pfm")));
    EXPECT_TRUE(image("2.pfm", run_process(mpirun({{2, render(words("2.pfm"))}}))) == expected);
    const ProcessResult without = alone({"--size", "160x160", "--spp", "40", "--no-guide", "-o", path("without.pfm")});
    EXPECT_FALSE(image("without.pfm", without) == expected) << "nothing is guided";
}

TEST_F(Ranks, StopAtTheErrorOfOne) {
    const auto words = [&](const char* name) { return Words{"--error", "0.2", "--seed", "3", "-o", path(name)}; };
    const std::string expected = image("1.pfm", alone(words("1.pfm")));
    EXPECT_TRUE(image("2.pfm", run_process(mpirun({{2, render(words("2.pfm"))}}))) == expected);
}

/// By default mpirun ends all ranks if one dies: the last checkpoint continues with the same bits.
TEST_F(Ranks, LeaveACheckpointIfOneDies) {
    const Words words = {"--spp", "1500", "--checkpoint", path("c"), "--checkpoint-every", "0.05s", "-o"};
    Words killed = words;
    killed.push_back(path("killed.pfm"));
    Process process(mpirun({{2, render(killed)}}));
    ASSERT_TRUE(process.brings_about([&] { return fs::exists(path("c")); }));
    const std::optional<pid_t> rank = process_of(path("killed.pfm"), 1);
    ASSERT_TRUE(rank);
    ::kill(*rank, SIGKILL);
    EXPECT_NE(process.wait().exit_code, 0);
    Words resumed = words;
    resumed.push_back(path("resumed.pfm"));
    resumed.insert(resumed.end(), {"--resume", path("c")});
    const std::string expected = image("whole.pfm", alone({"--spp", "1500", "-o", path("whole.pfm")}));
    EXPECT_TRUE(image("resumed.pfm", run_process(mpirun({{2, render(resumed)}}))) == expected);
}

/// A render that does not end before the dead rank is missed.
TEST_F(Ranks, GoOnIfOneDiesWhereTheLauncherAllowsIt) {
    Process process(mpirun({{3, render({"--spp", "16000000", "--checkpoint", path("c"), "--checkpoint-every", "0.05s",
                                        "-o", path("2.pfm")})}},
                           recovery_),
                    {{"CLARAY_RANK_SECONDS", "1"}});
    ASSERT_TRUE(process.brings_about([&] { return fs::exists(path("c")); }));
    // On a busy machine it may have been missed before.
    if (const std::optional<pid_t> rank = process_of(path("2.pfm"), 1)) ::kill(*rank, SIGKILL);
    const std::string words = "is dropped and the others go on: nothing was heard of it for 1 s";
    EXPECT_TRUE(process.brings_about([&] { return process.errors_so_far().find(words) != std::string::npos; }))
        << process.errors_so_far();
    const std::optional<pid_t> rank_0 = process_of(path("2.pfm"), 0);
    ASSERT_TRUE(rank_0);
    ::kill(*rank_0, SIGINT);
    const ProcessResult result = process.wait();
    ASSERT_TRUE(fs::exists(path("2.pfm"))) << result.errors;
    const std::string enough = std::to_string(2 * samples_in(result.output) + 64);
    ASSERT_NE(enough, "64") << result.output;
    const std::string resumed =
        image("resumed.pfm", alone({"--spp", enough, "--resume", path("c"), "-o", path("resumed.pfm")}));
    EXPECT_TRUE(resumed == image("1.pfm", alone({"--spp", enough, "-o", path("1.pfm")})));
}

/// Before MPI has started, for which rank 0 waits a minute, and before its first words.
TEST_F(Ranks, GoOnIfOneDiesAtTheStart) {
    const std::string expected = image("1.pfm", alone({"--spp", "8", "-o", path("1.pfm")}));
    const auto run = [&](const char* name, const Words& dying) {
        return run_process(mpirun({{1, render({"--spp", "8", "-o", path(name)})}, {1, dying}}, recovery_),
                           {{"CLARAY_RANK_SECONDS", "2"}});
    };
    const ProcessResult before = run("2.pfm", {"sh", "-c", "kill -9 $$"});
    EXPECT_TRUE(image("2.pfm", before) == expected);
    EXPECT_NE(before.errors.find("waiting for the other ranks to start"), std::string::npos) << before.errors;
    EXPECT_NE(before.errors.find("rank 0 goes on alone"), std::string::npos) << before.errors;
    const ProcessResult later = run("3.pfm", {CLARAY_FORGING_RANKS, "die"});
    EXPECT_TRUE(image("3.pfm", later) == expected);
    EXPECT_NE(later.errors.find("rank 1 is dropped and the others go on: nothing was heard of it"), std::string::npos)
        << later.errors;
}

/// Each of the others forges another message, or sends none. On a busy machine some may be lost before.
TEST_F(Ranks, DropTheOnesThatAreNotUnderstood) {
    const ProcessResult numbers = run_process({CLARAY_FORGING_RANKS, "ranks"});
    const int of_picture = std::stoi(numbers.output),
              of_frames = std::stoi(numbers.output.substr(numbers.output.find(' ')));
    for (const auto& [what, ranks] : {std::pair("picture", of_picture), std::pair("frames", of_frames)}) {
        const ProcessResult result =
            run_process(mpirun({{ranks, {CLARAY_FORGING_RANKS, what}}}, recovery_), {{"CLARAY_RANK_SECONDS", "1"}});
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_EQ(count(result.output, "as alone\n"), 1u) << result.output;
        EXPECT_EQ(count(result.output, "is dropped and the others go on: "), std::size_t(ranks - 1)) << result.output;
        EXPECT_EQ(count(result.output, "took frame"), 0u) << result.output;
    }
}

TEST_F(Ranks, ShareFramesOfAnAnimation) {
    const std::string scene = CLARAY_SOURCE_DIR "/tests/fuzz/corpus/gltf/posed.gltf";
    const auto frames = [&](const std::string& output, const Words& more = {}) {
        Words words = {CLARAY_PROGRAM, "render", scene, "--device", "cpu",  "--size", "16x12",
                       "--spp",        "2",      "-q",  "--frames", "0..6", "-o",     output};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    ASSERT_EQ(run_process(frames(path("1.%d.pfm"), {"--aov", "depth"})).exit_code, 0);
    const ProcessResult dealt = run_process(mpirun({{3, frames(path("3.%d.pfm"), {"--aov", "depth"})}}));
    ASSERT_EQ(dealt.exit_code, 0) << dealt.errors;
    for (int frame = 0; frame <= 6; ++frame)
        for (const char* end : {".pfm", ".depth.pfm", ".depth.png"}) {
            const std::string name = "." + std::to_string(frame) + end;
            EXPECT_TRUE(read_file(path("3" + name)) == read_file(path("1" + name))) << name;
        }
    const std::size_t shared = dealt.output.find("rank 1");
    EXPECT_GT(shared, dealt.output.find("3.6.pfm: "))
        << "six frames are dealt, all ranks share the last: " << dealt.output;
    const ProcessResult film = run_process(mpirun({{2, frames(path("f.y4m"))}}));
    EXPECT_EQ(film.exit_code, 0) << film.errors;
    EXPECT_TRUE(read_file(path("f.y4m")) == run_process(frames("-")).output);
}

TEST_F(Ranks, RefuseWhatDiffers) {
    const auto run = [&](const std::vector<std::pair<int, Words>>& programs) {
        return run_process(mpirun(programs, {"--mca", "odls_base_sigkill_timeout", "0"}));  // ends without a delay
    };
    const auto both = [&](const Words& more) {
        Words words = more;
        words.insert(words.end(), {"-o", path("x.pfm")});
        return run({{2, render(words)}});
    };
    const auto words = [&](const char* spp) { return render({"--spp", spp, "-o", path("x.pfm")}); };
    EXPECT_TRUE(says(run({{1, words("4")}, {1, words("5")}}), 2, "has other options than rank 0"));
    const auto with = [&](const std::string& variable) {
        Words program = words("4");
        program.insert(program.begin(), {"env", variable});
        return run({{1, words("4")}, {1, program}});
    };
    EXPECT_TRUE(says(with("OCL_ICD_VENDORS=/nonexistent"), 3, "no OpenCL platform on this machine"));
    const fs::path kernels = folder_ / "kernels";
    fs::copy(CLARAY_SOURCE_DIR "/kernels", kernels, fs::copy_options::recursive);
    std::ofstream(kernels / "sort/radix_sort.cl", std::ios::app) << "// another\n";
    EXPECT_TRUE(says(with("CLARAY_KERNEL_DIR=" + kernels.string()), 1, "install one version on all machines"));
    EXPECT_TRUE(says(both({"--spp", "0"}), 2, "--spp"));
    EXPECT_TRUE(says(both({"--time", "1us"}), 1, "is too short"));
    EXPECT_TRUE(says(both({"--adaptive"}), 2, "one device only"));
    EXPECT_FALSE(fs::exists(path("x.pfm")));
}

}  // namespace
}  // namespace claray::test
