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

KernelSet set_of(const std::vector<const char*>& files, const Defines& defines) {
    KernelSet set;
    for (const char* file : files) set.add(device(), {file, {}, defines});
    return set;
}

std::size_t joined(const std::vector<ProgramRequest>& requests) { return join(requests).members.size(); }

TEST(JointProgram, TakesFilesThatAgree) {
    const ProgramRequest a = {"trace/closest_hit.cl", {{"CLARAY_WIDE", "0"}, {"GROUP_SIZE", "1"}}};
    ProgramRequest b = {"trace/any_hit.cl", a.defines};
    EXPECT_EQ(joined({a, b}), 2u);
    EXPECT_EQ(joined({a, a}), 1u) << "a file is there once";
    b.defines[0].second = "1";  // what trace/closest_hit.clh, which both include, makes of it can't be both
    EXPECT_EQ(joined({a, b}), 1u);
    b.defines.push_back(a.defines[0]);  // the last one counts
    EXPECT_EQ(joined({a, b}), 2u);
}

TEST(JointProgram, KnowsTheDefaultsOfHeaders) {
    const ProgramRequest a = {"trace/closest_hit.cl", {{"CLARAY_WIDE", "0"}}};
    EXPECT_EQ(joined({a, {"trace/any_hit.cl", {}}}), 2u) << "0 is the default in closest_hit.clh";
    EXPECT_EQ(joined({{"trace/closest_hit.cl", {{"CLARAY_WIDE", "1"}}}, {"trace/any_hit.cl", {}}}), 1u);
    EXPECT_EQ(joined({{"trace/any_hit.cl", {}}, {"trace/closest_hit.cl", {{"CLARAY_WIDE", "1"}}}}), 1u);
}

TEST(JointProgram, GivesEachFileItsOwnMacros) {
    const ProgramRequest trace = {"trace/closest_hit.cl", {{"GROUP_SIZE", "1"}}};
    const ProgramRequest shade = {"render/shade_surface.cl", {{"GROUP_SIZE", "64"}}};
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
    queues.resize(CLARAY_QUEUE_LENGTHS, {9, {}});  // lists of the rays that are counted above
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
    load_jointly(device(), set_of({"render/resolve_film.cl", "render/measure_film.cl", "render/queues/empty_queues.cl"},
                                  never_seen));
    EXPECT_EQ(compile_statistics().compiled, before + 1);
    Kernel empty_queues = load("render/queues/empty_queues.cl", "empty_queues");
    (void)load("render/measure_film.cl", "measure_film");
    EXPECT_EQ(compile_statistics().compiled, before + 1) << "found in memory";
    expect_that_it_empties_queues(empty_queues);
}

TEST(KernelSets, AreThereWhenKernelsAreLoaded) {
    for (const unsigned side_by_side : {0u, 1u}) {
        const TemporaryFolder folder;
        const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
        const ScopedTuning tuning("compute/programs", "SIDE_BY_SIDE", side_by_side);
        const Defines never_seen = {{"CLARAY_TEST", std::to_string(84 + side_by_side)}};
        KernelSet set =
            set_of({"render/resolve_film.cl", "bvh/bounds.cl", "render/queues/empty_queues.cl"}, never_seen);
        set.add(set_of({"bvh/bounds.cl"}, never_seen));
        EXPECT_EQ(set.programs().size(), 3u) << "each once";
        EXPECT_FALSE(are_cached(device(), set));
        const CompileStatistics before = compile_statistics();
        load(device(), set);
        EXPECT_EQ(compile_statistics().compiled, before.compiled + 3);
        EXPECT_TRUE(are_cached(device(), set));
        for (const char* function : {"reset_header", "finish_bounds"})
            (void)load_kernel(device(), "bvh/bounds.cl", function, never_seen);
        Kernel empty_queues = load_kernel(device(), "render/queues/empty_queues.cl", "empty_queues", never_seen);
        EXPECT_EQ(compile_statistics().compiled, before.compiled + 3);
        EXPECT_EQ(compile_statistics().from_cache, before.from_cache) << "found in memory";
        expect_that_it_empties_queues(empty_queues);
    }
}

TEST(KernelSets, TellWhatDoesNotCompile) {
    const KernelSet broken = set_of({"render/measure_film.cl"}, {{"luminance", "no such word"}});
    for (const unsigned side_by_side : {0u, 1u}) {
        const ScopedTuning tuning("compute/programs", "SIDE_BY_SIDE", side_by_side);
        EXPECT_TRUE(throws_error(ErrorKind::device, "render/measure_film.cl", [&] { load(device(), broken); }));
    }
}

TEST(JointProgram, IsForgottenWhereItIsSlow) {
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const auto empty_queues = [&](const char* value) {
        return load_kernel(device(), "render/queues/empty_queues.cl", "empty_queues", {{"CLARAY_TEST", value}});
    };
    for (const bool optimized : {true, false}) {
        const char* value = optimized ? "78" : "79";
        load_jointly(device(),
                     set_of({"render/queues/empty_queues.cl", "render/add_light.cl"}, {{"CLARAY_TEST", value}}),
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
    EXPECT_NO_THROW(load_jointly(device(), set_of({"render/add_light.cl", "bvh/bounds.cl"}, broken)));
    EXPECT_THROW((void)load("render/add_light.cl", "add_light"), Error);
    EXPECT_NO_THROW((void)load("bvh/bounds.cl", "reset_header"));
}

}  // namespace
}  // namespace claray::test
