// PoCL's threads are bound to processors, one to each, unless the process may not use them all.
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

cpu_set_t processors_of(pid_t thread) {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    ::sched_getaffinity(thread, sizeof allowed, &allowed);
    return allowed;
}

std::vector<cpu_set_t> processors_of_threads() {
    std::vector<cpu_set_t> all;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
        all.push_back(processors_of(pid_t(std::stoi(entry.path().filename()))));
    return all;
}

TEST(BoundThreads, OneOnEachProcessor) {
    if (device().info().platform != "Portable Computing Language") GTEST_SKIP() << "not PoCL";
    if (std::getenv("POCL_MAX_PTHREAD_COUNT") != nullptr) GTEST_SKIP() << "PoCL has fewer threads";
    const cpu_set_t mine = processors_of(0);
    const std::vector<cpu_set_t> threads = processors_of_threads();
    for (cpu_set_t of_thread : threads) {
        cpu_set_t both;
        CPU_AND(&both, &of_thread, &mine);
        EXPECT_TRUE(CPU_EQUAL(&both, &of_thread)) << "a thread runs where the process may not";
    }
    if (CPU_COUNT(&mine) != ::sysconf(_SC_NPROCESSORS_CONF)) return;
    for (std::size_t i = 0; i < std::size_t(CPU_COUNT(&mine)); ++i)
        EXPECT_TRUE(
            std::ranges::any_of(threads, [&](const cpu_set_t& of) { return CPU_COUNT(&of) == 1 && CPU_ISSET(i, &of); }))
            << "processor " << i << " has no thread of its own";
}

TEST(BoundThreads, NotWhereTheProcessMayNotRun) {
    cpu_set_t mine = processors_of(0), last;
    if (CPU_COUNT(&mine) < 2) GTEST_SKIP() << "one processor only";
    std::size_t i = CPU_SETSIZE - 1;
    while (!CPU_ISSET(i, &mine)) --i;
    CPU_ZERO(&last);
    CPU_SET(i, &last);
    ProcessResult on_last;
    std::thread([&] {
        ASSERT_EQ(::sched_setaffinity(0, sizeof last, &last), 0);
        on_last = run_process({this_program(), "--gtest_filter=BoundThreads.OneOnEachProcessor"});
    }).join();
    EXPECT_EQ(on_last.exit_code, 0) << on_last.output;
}

TEST(BoundThreads, NotIfTheUserSaysSo) {
    const ProcessResult unbound =
        run_process({this_program(), "--gtest_filter=BoundThreads.OneOnEachProcessor"}, {{"POCL_AFFINITY", "0"}});
    cpu_set_t mine = processors_of(0);
    const bool may_be_bound = CPU_COUNT(&mine) > 1 && CPU_COUNT(&mine) == ::sysconf(_SC_NPROCESSORS_CONF);
    if (!may_be_bound || device().info().platform != "Portable Computing Language") GTEST_SKIP() << "never bound here";
    EXPECT_NE(unbound.exit_code, 0) << unbound.output;
}

}  // namespace
}  // namespace claray::test
