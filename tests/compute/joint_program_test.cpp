// Several kernel files in one program: which of them can share one, and that their results are the same.
#include "host/compute/programs/joint_program.hpp"

#include <gtest/gtest.h>

#include "claray/shared/path.h"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

std::size_t joined(const std::vector<KernelRequest>& requests) { return join(requests).members.size(); }

TEST(JointProgram, TakesFilesThatAgree) {
    const KernelRequest a = {"trace/closest_hit.cl", {{"CLARAY_WIDE", "0"}, {"GROUP_SIZE", "1"}}};
    KernelRequest b = {"trace/any_hit.cl", a.defines};
    EXPECT_EQ(joined({a, b}), 2u);
    EXPECT_EQ(joined({a, a}), 1u) << "a file is there once";
    b.defines[0].second = "1";  // what trace/closest_hit.clh, which both include, makes of it can't be both
    EXPECT_EQ(joined({a, b}), 1u);
    b.defines.push_back(a.defines[0]);  // the last one counts
    EXPECT_EQ(joined({a, b}), 2u);
}

TEST(JointProgram, KnowsTheDefaultsOfHeaders) {
    const KernelRequest a = {"trace/closest_hit.cl", {{"CLARAY_WIDE", "0"}}};
    EXPECT_EQ(joined({a, {"trace/any_hit.cl", {}}}), 2u) << "0 is the default in closest_hit.clh";
    EXPECT_EQ(joined({{"trace/closest_hit.cl", {{"CLARAY_WIDE", "1"}}}, {"trace/any_hit.cl", {}}}), 1u);
    EXPECT_EQ(joined({{"trace/any_hit.cl", {}}, {"trace/closest_hit.cl", {{"CLARAY_WIDE", "1"}}}}), 1u);
}

TEST(JointProgram, GivesEachFileItsOwnMacros) {
    const KernelRequest trace = {"trace/closest_hit.cl", {{"GROUP_SIZE", "1"}}};
    const KernelRequest shade = {"render/shade_surface.cl", {{"GROUP_SIZE", "64"}}};
    const JointSource joint = join({trace, shade, {"render/add_light.cl", {}}});
    ASSERT_EQ(joint.members.size(), 3u) << "no header of both mentions GROUP_SIZE";
    EXPECT_EQ(joint.source.text,
              "#define GROUP_SIZE 1\n#include \"trace/closest_hit.cl\"\n"
              "#undef GROUP_SIZE\n#define GROUP_SIZE 64\n#include \"render/shade_surface.cl\"\n"
              "#undef GROUP_SIZE\n#include \"render/add_light.cl\"\n");
}

void expect_that_it_empties_queues(Kernel& kernel) {
    std::vector<QueueLength> queues;
    for (const std::uint32_t length : {7u, 5u, 1u, 3u, 2u}) queues.push_back({length, {}});
    const Buffer<QueueLength> lengths(device(), queues);
    const Buffer<std::uint64_t> totals(device(), std::vector<std::uint64_t>{10, 20});
    kernel.run({1, 0}, lengths, totals);
    EXPECT_EQ(totals.read(), (std::vector<std::uint64_t>{23, 25}));
    for (const QueueLength& queue : lengths.read()) EXPECT_EQ(queue.length, 0u);
}

TEST(JointProgram, CompilesOnceAndServesThoseWhoAsk) {
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const Defines never_seen = {{"CLARAY_TEST", "77"}};
    const auto load = [&](const char* file, const char* function) {
        return load_kernel(device(), file, function, never_seen);
    };
    const unsigned before = compile_statistics().compiled;
    compile_jointly(device(), [&] {
        (void)load("render/resolve_film.cl", "resolve_film");
        (void)load("render/measure_film.cl", "measure_film");
        (void)load("render/empty_queues.cl", "empty_queues");
    });
    EXPECT_EQ(compile_statistics().compiled, before + 1);
    Kernel empty_queues = load("render/empty_queues.cl", "empty_queues");
    (void)load("render/measure_film.cl", "measure_film");
    EXPECT_EQ(compile_statistics().compiled, before + 1) << "found in memory";
    expect_that_it_empties_queues(empty_queues);
}

TEST(SideBySide, ProgramsAreThereWhenKernelsAreLoaded) {
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const Defines never_seen = {{"CLARAY_TEST", "80"}};
    const auto load = [&](const char* file, const char* function) {
        return load_kernel(device(), file, function, never_seen);
    };
    const auto load_all = [&] {
        (void)load("render/resolve_film.cl", "resolve_film");
        (void)load("bvh/bounds.cl", "reset_header");
        (void)load("bvh/bounds.cl", "finish_bounds");
        (void)load("render/empty_queues.cl", "empty_queues");
    };
    const auto compiled = [before = compile_statistics().compiled] { return compile_statistics().compiled - before; };
    {
        const ScopedTuning off("compute/programs", "SIDE_BY_SIDE", 0);
        compile_side_by_side(device(), load_all);
        EXPECT_EQ(compiled(), 0u);
    }
    const ScopedTuning on("compute/programs", "SIDE_BY_SIDE", 1);
    compile_side_by_side(device(), load_all);
    EXPECT_EQ(compiled(), 3u);
    const unsigned from_cache = compile_statistics().from_cache;
    load_all();
    Kernel empty_queues = load("render/empty_queues.cl", "empty_queues");
    EXPECT_EQ(compiled(), 3u);
    EXPECT_EQ(compile_statistics().from_cache, from_cache) << "found in memory";
    expect_that_it_empties_queues(empty_queues);
}

TEST(SideBySide, WhatDoesNotCompileIsToldByWhoLoadsIt) {
    const ScopedTuning on("compute/programs", "SIDE_BY_SIDE", 1);
    const Defines broken = {{"luminance", "no such word"}, {"CLARAY_TEST", "81"}};
    const auto load = [&] { (void)load_kernel(device(), "render/measure_film.cl", "measure_film", broken); };
    compile_side_by_side(device(), load);
    EXPECT_TRUE(throws_error(ErrorKind::device, "render/measure_film.cl", load));
}

TEST(JointProgram, IsForgottenWhereItIsSlow) {
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const auto empty_queues = [&](const char* value) {
        return load_kernel(device(), "render/empty_queues.cl", "empty_queues", {{"CLARAY_TEST", value}});
    };
    for (const bool optimized : {true, false}) {
        const char* value = optimized ? "78" : "79";
        compile_jointly(
            device(),
            [&] {
                (void)empty_queues(value);
                (void)load_kernel(device(), "render/add_light.cl", "add_light", {{"CLARAY_TEST", value}});
            },
            optimized);
        const unsigned before = compile_statistics().compiled;
        Kernel kernel = empty_queues(value);
        EXPECT_EQ(compile_statistics().compiled, before);
        forget_slow_programs(device());
        (void)empty_queues(value);
        EXPECT_EQ(compile_statistics().compiled, before + (optimized ? 0 : 1));
        expect_that_it_empties_queues(kernel);  // it is still there
    }
}

TEST(JointProgram, LeavesErrorsToWhoAsksForTheKernel) {
    const Defines broken = {{"CLARAY_SHARED_PATH_H", "1"}};  // the header is taken for included
    const auto load = [&](const char* file, const char* function) {
        return load_kernel(device(), file, function, broken);
    };
    EXPECT_NO_THROW(compile_jointly(device(), [&] {
        (void)load("render/add_light.cl", "add_light");
        (void)load("bvh/bounds.cl", "reset_header");
    }));
    EXPECT_THROW((void)load("render/add_light.cl", "add_light"), Error);
    EXPECT_NO_THROW((void)load("bvh/bounds.cl", "reset_header"));
}

}  // namespace
}  // namespace claray::test
