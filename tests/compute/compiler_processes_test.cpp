// Programs that other processes compile for the cache.
#include "host/compute/programs/compiler_processes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "host/compute/programs/joint_program.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

class CompilerProcesses : public testing::Test {
protected:
    ~CompilerProcesses() override { set_compiler_program({}); }

    /// One that knows no programs yet.
    static Device open() {
        const Device fresh = Device::open(std::to_string(device().info().index));
        fresh.set_tuning("compute/programs", "PROCESSES", 4);
        fresh.set_tuning("compute/programs", "SIDE_BY_SIDE", 0);
        return fresh;
    }
    static void load(const Device& on) {
        const Defines never_seen = {{"CLARAY_TEST", "78"}};
        static_cast<void>(load_kernel(on, "render/empty_queues.cl", "empty_queues", never_seen));
        static_cast<void>(load_kernel(on, "bvh/bounds.cl", "reset_header", never_seen));
    }
    static void compile_and_load(const Device& on) {
        compile_side_by_side(on, [&] { load(on); });
        load(on);
    }
    struct Counts {
        unsigned compiled, from_cache;
        bool operator==(const Counts&) const = default;
    };
    /// In this process.
    static Counts counts_of(const std::function<void()>& work) {
        const CompileStatistics before = compile_statistics();
        work();
        const CompileStatistics after = compile_statistics();
        return {after.compiled - before.compiled, after.from_cache - before.from_cache};
    }

    TemporaryFolder folder_;
    ScopedEnvironment cache_dir_{"CLARAY_CACHE_DIR", (folder_.path() / "cache").string()};
};

TEST_F(CompilerProcesses, FillTheCache) {
    const Device fresh = open();
    set_compiler_program(CLARAY_PROGRAM);
    ASSERT_TRUE(has_compiler_processes(fresh));
    EXPECT_EQ(counts_of([&] { compile_and_load(fresh); }), (Counts{0, 2}));
}

TEST_F(CompilerProcesses, NoneWithoutAProgramOrOnDevicesThatDoNotGain) {
    const Device fresh = open();
    EXPECT_FALSE(has_compiler_processes(fresh));
    EXPECT_EQ(counts_of([&] { compile_and_load(fresh); }), (Counts{2, 0}));
    set_compiler_program(CLARAY_PROGRAM);
    fresh.set_tuning("compute/programs", "PROCESSES", 0);
    EXPECT_FALSE(has_compiler_processes(fresh));
}

TEST_F(CompilerProcesses, WhatFailsIsCompiledHere) {
    for (const char* program : {"/bin/false", "/no/such/program"}) {
        const ScopedEnvironment empty("CLARAY_CACHE_DIR", (folder_.path() / "other").string());
        std::filesystem::remove_all(folder_.path() / "other");
        set_compiler_program(program);
        EXPECT_EQ(counts_of([&] { compile_and_load(open()); }), (Counts{2, 0})) << program;
    }
}

TEST_F(CompilerProcesses, ThreadsDoNotCompileTheSameTwice) {
    const std::filesystem::path script = folder_.path() / "compiler", calls = folder_.path() / "calls";
    std::ofstream(script) << "#!/bin/sh\necho call >> '" << calls.string() << "'\nexec '" << CLARAY_PROGRAM
                          << "' \"$@\"\n";
    std::filesystem::permissions(script, std::filesystem::perms::owner_all);
    set_compiler_program(script.string());
    const Device devices[] = {open(), open()};
    EXPECT_EQ(counts_of([&] {
                  std::thread other([&] { compile_and_load(devices[1]); });
                  compile_and_load(devices[0]);
                  other.join();
              }),
              (Counts{0, 4}));
    std::ifstream file(calls);
    EXPECT_EQ(std::count(std::istreambuf_iterator<char>(file), {}, '\n'), 2);
}

TEST_F(CompilerProcesses, SayWhatTheyCannotCompile) {
    const ProcessResult result = Process({CLARAY_PROGRAM, "compile", "--program", "no_such.cl"}).wait();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.errors.find("no kernel file no_such.cl"), std::string::npos) << result.errors;
    EXPECT_TRUE(throws_error(ErrorKind::device, "cannot compile the kernel sort/radix_sort.cl", [&] {
        compile_for_cache(open(), {"sort/radix_sort.cl", "-DITEMS=nonsense("});
    }));
}

}  // namespace
}  // namespace claray::test
