// Programs that other processes compile for the cache.
#include "host/compute/programs/compiler_processes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "host/base/process/process.hpp"
#include "tests/support/device.hpp"
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
    static ProgramRequest program(const char* never_seen) {
        return {"render/queues/empty_queues.cl", {{"CLARAY_TEST", never_seen}}};
    }
    static void compile_and_load(const Device& on) {
        KernelSet set;
        for (const char* never_seen : {"78", "79"}) set.add(program(never_seen));
        load(on, set);
        for (const auto& [file, defines] : set.programs())
            static_cast<void>(load_kernel(on, file, "empty_queues", defines));
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

    /// Programs that call `claray` and add a line to a file for each call, or for each request.
    std::string script_that_notes_calls(const std::filesystem::path& file) const {
        return script("echo call >> '" + file.string() + "'\nexec '" + CLARAY_PROGRAM + "' \"$@\"\n");
    }
    std::string script_that_notes_requests(const std::filesystem::path& file) const {
        return script("tee -a '" + file.string() + "' | '" + CLARAY_PROGRAM + "' \"$@\"\n");
    }
    static long lines_of(const std::filesystem::path& path) {
        std::ifstream file(path);
        return std::count(std::istreambuf_iterator<char>(file), {}, '\n');
    }

    TemporaryFolder folder_;
    ScopedEnvironment cache_dir_{"CLARAY_CACHE_DIR", (folder_.path() / "cache").string()};

private:
    std::string script(const std::string& text) const {
        const std::filesystem::path path = folder_.path() / "compiler";
        std::ofstream(path) << "#!/bin/sh\n" << text;
        std::filesystem::permissions(path, std::filesystem::perms::owner_all);
        return path.string();
    }
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

TEST_F(CompilerProcesses, NoneIfTheCacheCannotBeWritten) {
    const std::filesystem::path file = folder_.path() / "file", calls = folder_.path() / "calls";
    std::ofstream(file) << "not a folder";
    const ScopedEnvironment no_folder("CLARAY_CACHE_DIR", file.string());
    set_compiler_program(script_that_notes_calls(calls));
    EXPECT_EQ(counts_of([&] { compile_and_load(open()); }), (Counts{2, 0}));
    EXPECT_EQ(lines_of(calls), 0);
}

TEST_F(CompilerProcesses, ThreadsDoNotCompileTheSameTwice) {
    const std::filesystem::path requests = folder_.path() / "requests";
    set_compiler_program(script_that_notes_requests(requests));
    const Device devices[] = {open(), open()};
    EXPECT_EQ(counts_of([&] {
                  std::thread other([&] { compile_and_load(devices[1]); });
                  compile_and_load(devices[0]);
                  other.join();
              }),
              (Counts{0, 4}));
    EXPECT_EQ(lines_of(requests), 2);
}

TEST_F(CompilerProcesses, AnswerEachProgram) {
    AnsweringProcess compiler(
        {CLARAY_PROGRAM, "compile", "--serve", "--device", std::to_string(device().info().index)});
    EXPECT_EQ(compiler.ask("no_such.cl\t"), "failed");
    EXPECT_EQ(compiler.ask("render/queues/empty_queues.cl"), "done");
    EXPECT_EQ(compiler.ask("render/queues/empty_queues.cl\tuint=nonsense("), "failed");
    EXPECT_FALSE(compiler.has_ended());
    AnsweringProcess none({"/bin/true"});
    EXPECT_EQ(none.ask("render/queues/empty_queues.cl"), "");
    EXPECT_TRUE(none.has_ended());
    EXPECT_TRUE(AnsweringProcess({"/no/such/program"}).has_ended());
}

/// A second call uses the process of the first.
TEST_F(CompilerProcesses, AreKept) {
    const std::filesystem::path calls = folder_.path() / "calls";
    set_compiler_program(script_that_notes_calls(calls));
    {
        const KeepCompilers keep;
        compile_in_processes(open(), {program("1")});
        compile_in_processes(open(), {program("2")});
        EXPECT_EQ(lines_of(calls), 1);
    }
    compile_in_processes(open(), {program("3")});
    EXPECT_EQ(lines_of(calls), 2) << "it ends with the last who keeps it";
}

}  // namespace
}  // namespace claray::test
