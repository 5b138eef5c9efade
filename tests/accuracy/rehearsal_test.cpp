#include "host/accuracy/rehearsal.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

TEST(Rehearsal, LeavesNothingToCompile) {
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const Scene scene = *builtin_scene("cornell");
    const StudyOptions options{.runs = 2, .rays = 1u << 16};
    const auto begun = compile_statistics().compiled;
    {
        Rehearsal rehearsal(device(), scene, options, {{"sums", study_sums, nullptr, false}}, 2);
        rehearsal.wait();
    }
    const auto rehearsed = compile_statistics().compiled;
    EXPECT_GT(rehearsed, begun);
    const Device fresh = Device::open(std::to_string(device().info().index));  // has no kernel in memory
    EXPECT_FALSE(study_sums(fresh, scene, options, {}).points.empty());
    EXPECT_EQ(compile_statistics().compiled, rehearsed);
}

std::atomic<bool> began = false, was_ended = false;

Study study_without_end(const Device&, const Scene&, const StudyOptions&, const AccuracyProgress& progress) try {
    for (began = true;;) (void)progress(0, "");
} catch (const Error&) {
    was_ended = true;
    throw;
}

TEST(Rehearsal, EndsWithItsObject) {
    const Scene scene = *builtin_scene("cornell");
    {
        const Rehearsal rehearsal(device(), scene, {}, {{"endless", study_without_end}}, 1);
        while (!began) std::this_thread::yield();
    }
    EXPECT_TRUE(was_ended.exchange(false));
}

TEST(Rehearsal, EndsIfALookThrows) {
    const Scene scene = *builtin_scene("cornell");
    Rehearsal rehearsal(device(), scene, {}, {{"endless", study_without_end}}, 1);
    EXPECT_THROW(rehearsal.wait([] { throw Error(ErrorKind::user, "interrupted"); }), Error);
    rehearsal.wait();
}

TEST(Rehearsal, LeavesErrorsToTheStudies) {
    Scene dark = *builtin_scene("cornell");
    for (Material& material : dark.materials) material.emission = glm::vec3(0.f);
    const StudyOptions options{.config = {.width = 8, .height = 8}, .most_spp = 1u << 20};
    Rehearsal waits(device(), dark, options, {{"sampling", study_sampling}}, 1);
    waits.wait();
    waits.wait();
    EXPECT_THROW((void)study_sampling(device(), dark, {.config = options.config, .most_spp = 1}), Error);
}

}  // namespace
}  // namespace claray::test
