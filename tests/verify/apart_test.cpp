// Cases in child processes: those that hang or crash fail, and the others go on. These cases call no OpenCL.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <numeric>
#include <thread>

#include "host/base/seconds_since.hpp"
#include "host/verify/apart/child.hpp"
#include "host/verify/apart/run_apart.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

using verify::ApartJob;
using verify::CaseEvents;

[[noreturn]] void hang() {
    for (;;) ::pause();
}
[[noreturn]] void crash() {
    (void)std::signal(SIGABRT, SIG_DFL);  // the sanitizers' handlers would report it
    std::abort();
}

VerifyResult fine() {
    VerifyResult result;
    result.name = "fine", result.seed = 7, result.command = "again";
    result.checks = {{"figure", 3, 0.5, 1, "ulp", true}, {"other", 1, 2, 1, ""}};
    result.facts = {{"hash", "0123"}};
    result.failures = {"one", "two"};
    result.pictures = {{"title", {{{0.25f, 0.5f}, true, 0xff00ffu}}}};
    result.kernels = {"a", "b"};
    return result;
}

using Function = void (*)();

struct Heard {
    std::map<std::size_t, VerifyResult> ended;
    std::map<std::size_t, std::string> died;
    unsigned opened = 0;
};

/// Runs functions as cases, `threads` at once unless they are to run one by one, in so many processes.
Heard heard_of(const std::vector<Function>& functions, double limit, unsigned threads = 1, unsigned processes = 1) {
    ApartJob job;
    job.processes = [=](const DeviceInfo&) { return processes; };
    job.open = [] {
        DeviceInfo info;
        info.name = "none", info.extensions = {"cl_khr_fp64"}, info.fp64 = true;
        return info;
    };
    job.run = [&](std::span<const std::size_t> which, bool one_by_one, const CaseEvents& events) {
        std::mutex mutex;
        const auto run = [&](std::size_t i) {
            {
                const std::lock_guard lock(mutex);
                if (!events.begun(i)) return;
            }
            functions[i]();
            const std::lock_guard lock(mutex);
            events.ended(i, fine());
        };
        if (one_by_one || threads == 1) {
            for (const std::size_t i : which) run(i);
            return;
        }
        std::vector<std::thread> all;
        for (const std::size_t i : which) all.emplace_back(run, i);
        for (std::thread& thread : all) thread.join();
    };
    Heard heard;
    std::vector<std::size_t> all(functions.size());
    std::iota(all.begin(), all.end(), std::size_t(0));
    verify::run_in_children(job, all, limit,
                            {[&](const DeviceInfo& info) {
                                 EXPECT_EQ(info.name, "none");
                                 EXPECT_TRUE(info.fp64 && info.has("cl_khr_fp64"));
                                 ++heard.opened;
                             },
                             [&](std::size_t i, const VerifyResult& result) {
                                 EXPECT_TRUE(heard.ended.emplace(i, result).second) << i << " ended twice";
                             },
                             [&](std::size_t i, const std::string& why, double seconds) {
                                 EXPECT_GE(seconds, 0);
                                 EXPECT_TRUE(heard.died.emplace(i, why).second) << i << " died twice";
                             }});
    EXPECT_EQ(heard.opened, 1u);
    return heard;
}

constexpr Function nothing = [] {};

TEST(VerifyApart, ResultsArriveWhole) {
    const Heard heard = heard_of({nothing, nothing}, 60);
    ASSERT_EQ(heard.ended.size(), 2u);
    const VerifyResult &got = heard.ended.at(1), sent = fine();
    EXPECT_EQ(got.name, sent.name);
    EXPECT_EQ(got.seed, sent.seed);
    EXPECT_EQ(got.command, sent.command);
    ASSERT_EQ(got.checks.size(), 2u);
    EXPECT_EQ(got.checks[0].what, "figure");
    EXPECT_EQ(got.checks[0].tried, 3u);
    EXPECT_EQ(got.checks[0].worst, 0.5);
    EXPECT_EQ(got.checks[0].unit, "ulp");
    EXPECT_TRUE(got.checks[0].time);
    EXPECT_FALSE(got.holds());
    EXPECT_EQ(got.facts, sent.facts);
    EXPECT_EQ(got.failures, sent.failures);
    EXPECT_EQ(got.kernels, sent.kernels);
    ASSERT_EQ(got.pictures.size(), 1u);
    EXPECT_EQ(got.pictures[0].shapes[0].points, sent.pictures[0].shapes[0].points);
    EXPECT_EQ(got.pictures[0].shapes[0].color, 0xff00ffu);
    EXPECT_TRUE(heard.died.empty());
}

TEST(VerifyApart, ACaseThatCrashesOrHangsFailsAlone) {
    constexpr Function leave = [] { ::_exit(3); };
    const auto begin = std::chrono::steady_clock::now();
    const Heard heard = heard_of({nothing, crash, nothing, hang, leave, nothing}, 0.4);
    EXPECT_LT(seconds_since(begin), 20);
    EXPECT_EQ(heard.ended.size(), 3u);
    for (const std::size_t i : {0, 2, 5}) EXPECT_TRUE(heard.ended.contains(i)) << i;
    ASSERT_EQ(heard.died.size(), 3u);
    EXPECT_EQ(heard.died.at(1), "the driver ended the process by signal 6 (SIGABRT)");
    EXPECT_EQ(heard.died.at(3), "killed after 0.4 s without an end");
    EXPECT_EQ(heard.died.at(4), "the driver ended the process with exit code 3");
}

/// Which of those that ran side by side is guilty is known only when they run one by one.
TEST(VerifyApart, TheGuiltyOneOfManyIsFound) {
    constexpr Function wait_and_crash = [] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        crash();
    };
    constexpr Function slow = [] { std::this_thread::sleep_for(std::chrono::milliseconds(300)); };
    const Heard crashed = heard_of({nothing, slow, wait_and_crash, slow}, 60, 4);
    EXPECT_EQ(crashed.ended.size(), 3u);
    ASSERT_TRUE(crashed.died.contains(2));
    const Heard hung = heard_of({slow, hang, nothing}, 1, 4);
    EXPECT_EQ(hung.ended.size(), 2u);
    ASSERT_TRUE(hung.died.contains(1));
    EXPECT_EQ(hung.died.at(1), "killed after 1 s without an end");
}

/// Processes share the cases: each runs once, and one that crashes or hangs ends its own process only.
TEST(VerifyApart, ProcessesShareCases) {
    constexpr Function slow = [] { std::this_thread::sleep_for(std::chrono::milliseconds(400)); };
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(heard_of(std::vector<Function>(8, slow), 60, 1, 4).ended.size(), 8u);
    EXPECT_LT(seconds_since(begin), 8 * 0.4);
    const Heard heard = heard_of({slow, crash, slow, nothing, hang, slow, slow, crash, nothing}, 1, 1, 3);
    EXPECT_EQ(heard.ended.size(), 6u);
    ASSERT_EQ(heard.died.size(), 3u);
    EXPECT_EQ(heard.died.at(1), "the driver ended the process by signal 6 (SIGABRT)");
    EXPECT_EQ(heard.died.at(4), "killed after 1 s without an end");
}

TEST(VerifyApart, WhatTheChildThrowsArrives) {
    const ApartJob job = {
        []() -> DeviceInfo { throw Error(ErrorKind::usage, "no device matches 'x'", "choose one of y", "a report"); },
        [](std::span<const std::size_t>, bool, const CaseEvents&) {}};
    try {
        verify::run_in_children(job, {0}, 60, {});
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_STREQ(error.what(), "no device matches 'x'; choose one of y\na report");
    }
}

TEST(VerifyApart, ADriverThatOpensNoDeviceIsRefused) {
    ApartJob job = {[]() -> DeviceInfo { crash(); }, [](std::span<const std::size_t>, bool, const CaseEvents&) {}};
    EXPECT_TRUE(throws_error(ErrorKind::device, "the device cannot be opened: the driver ended the process by signal 6",
                             [&] { verify::run_in_children(job, {0}, 60, {}); }));
    job.open = []() -> DeviceInfo { hang(); };
    job.seconds_to_open = 0.3;
    EXPECT_TRUE(throws_error(ErrorKind::device, "the device cannot be opened: killed after 0.3 s",
                             [&] { verify::run_in_children(job, {0}, 60, {}); }));
}

/// As when Ctrl-C or a build server ends the program.
TEST(VerifyApart, TheChildDiesWithItsParent) {
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t parent = ::fork();
    if (parent == 0) {
        ::close(ends[0]);
        verify::Child child([&](const auto&) {
            (void)!::write(ends[1], "x", 1);
            hang();  // it keeps the end of the pipe open while it lives
        });
        hang();
    }
    ::close(ends[1]);
    char byte = 0;
    EXPECT_EQ(::read(ends[0], &byte, 1), 1);
    ::kill(parent, SIGKILL);
    ::waitpid(parent, nullptr, 0);
    EXPECT_EQ(::read(ends[0], &byte, 1), 0);  // returns when the child is dead
    ::close(ends[0]);
}

TEST(VerifyApart, ResultsAreReportedInOrder) {
    std::string reported;
    verify::InOrder in_order(3, [&](const VerifyResult& result) { reported += result.name; });
    VerifyResult result;
    for (const std::size_t i : {2, 0, 1}) {
        result.name = std::to_string(i);
        in_order.add(i, result);
        EXPECT_TRUE(i != 0 || reported == "0") << reported;
    }
    EXPECT_EQ(reported, "012");
}

}  // namespace
}  // namespace claray::test
