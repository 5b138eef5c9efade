// PoCL's threads are bound to processors, one to each, unless the process may not use them all. PoCL compiles a kernel
// once for all sizes of work-groups.
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "host/compute/drivers/known_faults.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

bool is_pocl() { return device().info().platform == "Portable Computing Language"; }

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

/// Run by the next tests: CTest tells PoCL not to bind the threads of all others.
TEST(BoundThreads, OfThisProcess) {
    if (std::getenv("BOUND_THREADS") == nullptr) GTEST_SKIP() << "run by the next tests";
    if (!is_pocl()) GTEST_SKIP() << "not PoCL";
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

/// `affinity` is that of the user; an empty one is none.
ProcessResult bound_in_a_process(const std::string& affinity) {
    return run_process({this_program(), "--gtest_filter=BoundThreads.OfThisProcess"},
                       {{"BOUND_THREADS", "1"}, {"POCL_AFFINITY", affinity}});
}

TEST(BoundThreads, OneOnEachProcessor) {
    const ProcessResult bound = bound_in_a_process("");
    EXPECT_EQ(bound.exit_code, 0) << bound.output;
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
        on_last = bound_in_a_process("");
    }).join();
    EXPECT_EQ(on_last.exit_code, 0) << on_last.output;
}

TEST(BoundThreads, NotIfTheUserSaysSo) {
    const ProcessResult unbound = bound_in_a_process("0");
    cpu_set_t mine = processors_of(0);
    const bool may_be_bound = CPU_COUNT(&mine) > 1 && CPU_COUNT(&mine) == ::sysconf(_SC_NPROCESSORS_CONF);
    if (!may_be_bound || !is_pocl()) GTEST_SKIP() << "never bound here";
    EXPECT_NE(unbound.exit_code, 0) << unbound.output;
}

/// Run by the next test, with its own caches.
TEST(GroupSizes, OfOneKernel) {
    if (std::getenv("GROUP_SIZES") == nullptr) GTEST_SKIP() << "run by the next test";
    Device fresh = Device::open(device().info().name);
    Kernel kernel = compile_kernel(fresh, "kernel void set(global uint* a) { a[get_global_id(0)] = 7; }", "set");
    const Buffer<std::uint32_t> values(fresh, 64);
    for (const std::size_t local : {16, 32, 64}) kernel.run({64, local}, values);
    EXPECT_EQ(values.read(), std::vector<std::uint32_t>(64, 7));
    std::ptrdiff_t programs = 0;  // in PoCL's folder, which goes when this process ends
    for (const auto& file : std::filesystem::recursive_directory_iterator(std::getenv("POCL_CACHE_DIR")))
        programs += file.path().extension() == ".so";
    std::printf("programs: %td\n", programs);
}

TEST(GroupSizes, AreCompiledOnceUnlessTheUserSaysSo) {
    if (!is_pocl()) GTEST_SKIP() << "not PoCL";
    const auto programs_written = [](const Variables& variables) {
        const TemporaryFolder folder;
        Variables all = variables;
        all["GROUP_SIZES"] = "1";
        all["POCL_CACHE_DIR"] = all["CLARAY_CACHE_DIR"] = folder.path().string();
        const ProcessResult run = run_process({this_program(), "--gtest_filter=GroupSizes.OfOneKernel"}, all);
        EXPECT_EQ(run.exit_code, 0) << run.output;
        const std::size_t at = run.output.find("programs: ");
        return at == std::string::npos ? 0 : std::atoi(run.output.c_str() + at + std::strlen("programs: "));
    };
    const int once = programs_written({});
    EXPECT_GT(once, 0);
    EXPECT_GE(programs_written({{"POCL_WORK_GROUP_SPECIALIZATION", "1"}}), once + 2);
}

TEST(KnownFaults, WarnOfDriversWithWrongResultsOnly) {
    EXPECT_EQ(known_fault(device().info()), "");
    DeviceInfo info;
    info.platform = "rusticl", info.name = "llvmpipe (LLVM 15.0.6, 256 bits)", info.driver = "22.3.6";
    const std::string fault = known_fault(info);
    for (const char* part : {"rusticl 22.3.6", "65,535 iterations", "apt-get install pocl-opencl-icd"})
        EXPECT_NE(fault.find(part), std::string::npos) << fault;
    info.name = "AMD Radeon";  // another compiler
    EXPECT_EQ(known_fault(info), "");
    info.platform = "Portable Computing Language", info.driver = "3.0-rc2";
    EXPECT_NE(known_fault(info).find("pocl-binary-distribution"), std::string::npos);
}

}  // namespace
}  // namespace claray::test
