// Tuning: tried values, kept values, written files. No test depends on speed.
#include "host/measure/tune.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host/compute/programs/kernel_sources.hpp"
#include "host/compute/tuning.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::measure {
namespace {

DeviceInfo named(const std::string& name, DeviceType type) {
    DeviceInfo info;
    info.name = name, info.type = type;
    return info;
}

/// Separate from the tests' device, whose tuning does not change.
Device fresh_device() { return Device::open(std::to_string(test::device().info().index)); }

TEST(Candidates, LastRowThatMatchesCounts) {
    const std::string table =
        "# a comment\n\n"
        "*    sort/a  X  fast            1 2 3\n"
        "gpu  sort/a  X  fast            4  # more\n"
        "cpu  sort/b  Y  balanced+rays   5 4294967295\n"
        "H200 sort/a  X  closest+any     6 7\n";
    const auto cpu = parse_candidates(table, "table", named("Xeon", DeviceType::cpu));
    ASSERT_EQ(cpu.size(), 2u);
    EXPECT_EQ(cpu[0].values, (std::vector<unsigned>{1, 2, 3}));
    EXPECT_EQ(cpu[1].values, (std::vector<unsigned>{5, 4294967295u}));
    EXPECT_EQ(cpu[1].work, (std::vector<std::string>{"balanced", "rays"}));
    EXPECT_EQ(parse_candidates(table, "table", named("A100", DeviceType::gpu)).at(0).values, std::vector<unsigned>{4});
    const auto h200 = parse_candidates(table, "table", named("NVIDIA H200", DeviceType::gpu));
    ASSERT_EQ(h200.size(), 1u);
    EXPECT_EQ(h200[0].values, (std::vector<unsigned>{6, 7}));
    EXPECT_EQ(h200[0].work, (std::vector<std::string>{"closest", "any"}));
}

TEST(Candidates, MalformedRowsNameTableAndLine) {
    for (const char* row : {"*", "* k", "* k P", "* k P fast", "* k P 1 2", "* k P fast one", "* k P fast 1 two",
                            "* k P fast -1", "* k P fast 4294967296", "* k P fast+ 1x", "* k P quick 1"})
        EXPECT_TRUE(test::throws_error(ErrorKind::user, "table:2: not a row of candidates", [&] {
            (void)parse_candidates(std::string("\n") + row, "table", test::device().info());
        })) << row;
}

TEST(Candidates, AreTheParametersOfTheTuningTable) {
    for (const DeviceInfo& info : {named("some device", DeviceType::cpu), named("some device", DeviceType::gpu),
                                   named("NVIDIA something", DeviceType::gpu)}) {
        Tuning table;
        apply_tuning(kernel_source("tuning.txt").text, "tuning.txt", info, table);
        const std::map<std::string, unsigned>& tuned = table.values;
        std::set<std::string> tried;
        for (const TuningCandidates& of : candidates_for(info)) {
            tried.insert(of.kernel + " " + of.parameter);
            EXPECT_EQ(tuned.count(of.kernel + " " + of.parameter), 1u)
                << of.kernel << " " << of.parameter << " is not in kernels/tuning.txt";
            for (const unsigned value : of.values)
                EXPECT_TRUE(table.ranges[of.kernel + " " + of.parameter].holds(value))
                    << "a user's table may not have " << of.kernel << " " << of.parameter << " " << value
                    << ", which claray tune may write";
            EXPECT_EQ(std::set<unsigned>(of.values.begin(), of.values.end()).size(), of.values.size());
        }
        for (const auto& [name, value] : tuned) {
            EXPECT_TRUE(table.ranges.count(name) == 1 && table.ranges[name].holds(value)) << name;
            if (name.starts_with("plan/model ")) continue;  // rates of the device, which claray tune measures
            EXPECT_EQ(tried.count(name), 1u)
                << "add a row for " << name
                << " to kernels/tuning_candidates.txt, with one value if it is not to be tried";
        }
    }
}

TEST(PairedRatio, MedianAndNoise) {
    const PairedRatio same = paired_ratio({1, 2, 3}, {1, 2, 3});
    EXPECT_EQ(same.ratio, 1);
    EXPECT_EQ(same.noise, 0);
    EXPECT_FALSE(same.faster());
    // A machine that slows down disturbs both alike.
    EXPECT_TRUE(paired_ratio({0.9, 1.8, 3.6, 7.2, 14.4}, {1, 2, 4, 8, 16}).faster());
    EXPECT_FALSE(paired_ratio({0.99, 1.98, 3.96}, {1, 2, 4}).faster()) << "not worth it";
    EXPECT_FALSE(paired_ratio({0.6, 1.3, 0.9, 1.2, 0.7}, {1, 1, 1, 1, 1}).faster()) << "noise";
    const PairedRatio noisy = paired_ratio({0.8, 0.9, 1.0, 0.7, 1.2}, {1, 1, 1, 1, 1});
    EXPECT_DOUBLE_EQ(noisy.ratio, 0.9);
    EXPECT_NEAR(noisy.noise, 1.2533 * 1.4826 * 0.1 / std::sqrt(5.0), 1e-12);
    EXPECT_EQ(paired_ratio({}, {}).ratio, 1);
}

TEST(WithRows, ReplacesItsOwnAndKeepsTheRest) {
    const DeviceInfo info = named("Some GPU #1", DeviceType::gpu);
    const std::string before =
        "# mine\n* trace/x GROUP 1\nSome_GPU__1 trace/x GROUP 2 # old\nSome_GPU__1 trace/x ITEMS 5\nOther trace/x "
        "GROUP 3";
    const std::string after = with_rows(before, info, {{"trace/x", "GROUP", 64, 0.75}, {"sort/y", "N", 9, 0.5}});
    EXPECT_EQ(after,
              "# mine\n* trace/x GROUP 1\nSome_GPU__1 trace/x ITEMS 5\nOther trace/x GROUP 3\n"
              "Some_GPU__1  trace/x  GROUP  64  # claray tune: 25.0 % less time\n"
              "Some_GPU__1  sort/y  N  9  # claray tune: 50.0 % less time\n");
    Tuning tuning;
    apply_tuning(after, "table", info, tuning);
    EXPECT_EQ(tuning.values.at("trace/x GROUP"), 64u) << "the pattern is the device's";
    EXPECT_EQ(tuning.values.at("trace/x ITEMS"), 5u);
    EXPECT_EQ(with_rows("", info, {}), "");
}

class Tune : public testing::Test {
protected:
    std::vector<Trial> run(const TuningCandidates& candidates) {
        TuneOptions options;
        options.scenes = {"soup:300"};
        options.width = 16, options.height = 12, options.repeat = 3;
        std::vector<Trial> seen;
        rows_ = tune(device_, options, {candidates}, [&](const std::vector<Trial>& trials) { seen = trials; });
        return seen;
    }
    Device device_ = fresh_device();
    std::vector<TunedRow> rows_;
};

TEST_F(Tune, TriesEveryValueAndLeavesTheBestInForce) {
    const unsigned before = device_.tuning("trace/any_hit", "GROUP_SIZE");
    const auto trials = run({"trace/any_hit", "GROUP_SIZE", {"any"}, {32, 64, 128}});
    ASSERT_GE(trials.size(), 3u);
    EXPECT_TRUE(trials[0].in_force);
    EXPECT_EQ(trials[0].value, before);
    EXPECT_EQ(trials[0].ratio, 1);
    std::set<unsigned> values;
    for (const Trial& trial : trials) {
        values.insert(trial.value);
        EXPECT_EQ(trial.failure, "") << trial.value;
        EXPECT_GT(trial.milliseconds, 0);
    }
    for (const unsigned value : {32u, 64u, 128u}) EXPECT_EQ(values.count(value), 1u);
    EXPECT_EQ(device_.tuning("trace/any_hit", "GROUP_SIZE"), rows_.empty() ? before : rows_[0].value);
}

TEST_F(Tune, ValuesThatFailOrChangeResultsAreRefused) {
    device_.set_tuning("trace/any_hit", "BATCH", 0);  // batches have groups of one item, whatever the row says
    const auto failing = run({"trace/any_hit", "GROUP_SIZE", {"any"}, {1u << 30}});
    EXPECT_NE(failing.at(1).failure, "");
    EXPECT_EQ(failing[1].failure.find('\n'), std::string::npos);
    // A macro that makes the kernel wrong: back faces are no longer hit.
    device_.set_tuning("trace/any_hit", "CULL_BACK_FACES", 0);
    const auto wrong = run({"trace/any_hit", "CULL_BACK_FACES", {"any"}, {1}});
    EXPECT_EQ(wrong.at(1).failure, "gives different results");
    EXPECT_FALSE(wrong[1].kept);
    EXPECT_EQ(device_.tuning("trace/any_hit", "CULL_BACK_FACES"), 0u);
    EXPECT_TRUE(rows_.empty());
}

TEST_F(Tune, EveryKindOfWorkRuns) {
    for (const char* work : {"fast", "balanced", "rays", "closest", "any", "render"}) {
        const auto trials = run({"trace/closest_hit", "GROUP_SIZE", {work}, {32, 64}});
        for (const Trial& trial : trials) EXPECT_GT(trial.milliseconds, 0) << work << " " << trial.failure;
    }
}

}  // namespace
}  // namespace claray::measure
