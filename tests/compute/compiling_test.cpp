// What is told while kernels are compiled.
#include "claray/program/compiling.hpp"

#include <gtest/gtest.h>

#include "claray/program.hpp"
#include "host/compute/programs/kernel_set.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

struct Three {
    Kernel a, b, c;
};

class CompilingIsTold : public testing::Test {
protected:
    ~CompilingIsTold() override { on_compiling({}); }

    static Device open(unsigned side_by_side) {
        const Device fresh = Device::open(std::to_string(device().info().index));
        fresh.set_tuning("compute/programs", "PROCESSES", 0);
        fresh.set_tuning("compute/programs", "SIDE_BY_SIDE", side_by_side);
        return fresh;
    }
    static KernelsOf<Three> kernels() {
        const auto request = [](const char* never_seen) {
            return KernelRequest{"render/queues/empty_queues.cl", "empty_queues", {{"CLARAY_TEST", never_seen}}};
        };
        return {{&Three::a, request("81")}, {&Three::b, request("82")}, {&Three::c, request("83")}};
    }
    /// What is told while three programs are compiled at once, as far as the cache lacks them.
    static std::vector<CompileProgress> told_by(const Device& on) {
        std::vector<CompileProgress> told;
        on_compiling([&](const CompileProgress& progress) { told.push_back(progress); });
        Three three;
        load(on, programs_of(on, kernels()));
        load(on, kernels(), three);
        on_compiling({});
        return told;
    }
    /// Both count from the start of the process.
    static std::vector<CompileProgress> since_the_first(std::vector<CompileProgress> told) {
        const CompileProgress before = told.empty() ? CompileProgress() : told.front();
        for (CompileProgress& one : told) one.done -= before.done, one.total -= before.done;
        return told;
    }

    TemporaryFolder folder_;
    ScopedEnvironment cache_dir_{"CLARAY_CACHE_DIR", folder_.path().string()};
};

TEST_F(CompilingIsTold, AtOnceWithTheNumberOfAll) {
    for (const unsigned side_by_side : {0u, 1u}) {
        const ScopedEnvironment empty("CLARAY_CACHE_DIR", (folder_ / std::to_string(side_by_side)).string());
        EXPECT_EQ(since_the_first(told_by(open(side_by_side))),
                  (std::vector<CompileProgress>{{0, 3}, {1, 3}, {2, 3}, {3, 3}}));
        EXPECT_TRUE(told_by(open(side_by_side)).empty()) << "the cache has them";
    }
}

TEST_F(CompilingIsTold, OfASingleKernel) {
    std::vector<CompileProgress> told;
    on_compiling([&](const CompileProgress& progress) { told.push_back(progress); });
    Three three;
    load(open(0), kernels(), three);
    ASSERT_EQ(told.size(), 6u);
    EXPECT_EQ(told.back().done, told.back().total);
    EXPECT_EQ(told.front().done + 1, told.front().total);
}

TEST_F(CompilingIsTold, InLinesOffATerminal) {
    std::FILE* const file = std::fopen((folder_ / "told").c_str(), "w");
    const TellCompiling tell = compiling_lines(file);
    for (unsigned done = 0; done <= 15; ++done) tell({done, 15});
    std::fclose(file);
    EXPECT_EQ(read_file(folder_ / "told"), "claray: compiling 1 of 15 kernels, once for this device\n")
        << "the others come too soon after it";
    EXPECT_EQ(text_of({6, 15}), "compiling 7 of 15 kernels, once for this device");
}

}  // namespace
}  // namespace claray::test
