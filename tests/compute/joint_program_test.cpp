// Several kernel files in one program: which can share one, and that they do what they do alone.
#include "host/compute/joint_program.hpp"

#include <gtest/gtest.h>

#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

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
        (void)load("render/resolve_film.cl", "measure_noise");
        (void)load("render/advance_queues.cl", "advance_queues");
    });
    EXPECT_EQ(compile_statistics().compiled, before + 1);
    Kernel advance = load("render/advance_queues.cl", "advance_queues");
    (void)load("render/resolve_film.cl", "measure_noise");
    EXPECT_EQ(compile_statistics().compiled, before + 1) << "found in memory";
    const Buffer<std::uint32_t> worked_off(device(), std::vector<std::uint32_t>{7}),
        next(device(), std::vector<std::uint32_t>{5}), shadow(device(), std::vector<std::uint32_t>{3});
    const Buffer<std::uint64_t> totals(device(), std::vector<std::uint64_t>{10, 20});
    advance.run({1, 0}, worked_off, next, shadow, totals);
    EXPECT_EQ(totals.read(), (std::vector<std::uint64_t>{15, 23}));
    EXPECT_EQ(worked_off.read()[0], 0u);
}

TEST(JointProgram, IsForgottenWhereItIsSlow) {
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const auto advance = [&](const char* value) {
        return load_kernel(device(), "render/advance_queues.cl", "advance_queues", {{"CLARAY_TEST", value}});
    };
    for (const bool optimized : {true, false}) {
        const char* value = optimized ? "78" : "79";
        compile_jointly(
            device(),
            [&] {
                (void)advance(value);
                (void)load_kernel(device(), "render/add_light.cl", "add_light", {{"CLARAY_TEST", value}});
            },
            optimized);
        const unsigned before = compile_statistics().compiled;
        Kernel kernel = advance(value);
        EXPECT_EQ(compile_statistics().compiled, before);
        forget_slow_programs(device());
        (void)advance(value);
        EXPECT_EQ(compile_statistics().compiled, before + (optimized ? 0 : 1));
        const Buffer<std::uint32_t> worked_off(device(), std::vector<std::uint32_t>{7}),
            next(device(), std::vector<std::uint32_t>{5}), shadow(device(), std::vector<std::uint32_t>{3});
        const Buffer<std::uint64_t> totals(device(), std::vector<std::uint64_t>{10, 20});
        kernel.run({1, 0}, worked_off, next, shadow, totals);  // it is still there
        EXPECT_EQ(totals.read(), (std::vector<std::uint64_t>{15, 23}));
    }
}

TEST(JointProgram, LeavesErrorsToWhoAsksForTheKernel) {
    const Defines broken = {{"CLARAY_SHARED_PATH_H", "1"}};  // the header is taken for included
    const auto load = [&](const char* file, const char* function) {
        return load_kernel(device(), file, function, broken);
    };
    EXPECT_NO_THROW(compile_jointly(device(), [&] {
        (void)load("render/add_light.cl", "add_light");
        (void)load("render/advance_queues.cl", "advance_queues");
    }));
    EXPECT_THROW((void)load("render/add_light.cl", "add_light"), Error);
    EXPECT_NO_THROW((void)load("render/advance_queues.cl", "advance_queues"));
}

}  // namespace
}  // namespace claray::test
