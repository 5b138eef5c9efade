// How an image is cut into batches, and how large these are.
#include "host/render/schedule/pass_schedule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/render/schedule/pending_batches.hpp"

namespace claray::test {
namespace {

/// Whole pixels, as PassSchedule does, since their paths are coherent; parts of one only where there is no room for it.
TEST(PendingBatches, TakeAllSamplesOfAPixel) {
    PendingBatches left({{10, 5, 3, 16, 0}, {40, 2, 0, 100, 0}});
    std::vector<std::uint32_t> next(50);
    for (std::uint32_t p = 10; p < 15; ++p) next[p] = 3;
    std::uint64_t samples = left.samples();
    while (!left.empty()) {
        const Batch batch = left.next(70);
        ASSERT_LE(batch.pixels * batch.samples, 70u);
        EXPECT_TRUE(batch.first_pixel < 40 ? batch.samples == 16 : batch.samples == 70 || batch.samples == 30);
        for (std::uint32_t p = batch.first_pixel; p < batch.first_pixel + batch.pixels; ++p) {
            EXPECT_EQ(next[p], batch.first_sample) << p;
            next[p] += batch.samples;
        }
        EXPECT_EQ(left.samples(), samples -= batch.pixels * batch.samples);
    }
    for (std::uint32_t p = 0; p < 50; ++p)
        EXPECT_EQ(next[p], p >= 10 && p < 15 ? 19u : p == 40 || p == 41 ? 100u : 0u) << p;
}

/// Each pixel gets samples 0, 1, 2 ... spp - 1, once and in this order, whatever the batches' sizes.
TEST(PassSchedule, EveryPixelGetsItsSamplesInOrder) {
    std::mt19937 random(1);
    for (const std::uint32_t pixels : {1u, 2u, 7u, 100u})
        for (const std::uint32_t spp : {1u, 2u, 21u, 100u})
            for (const std::uint32_t paths : {1u, 5u, 64u, 100'000u}) {
                PassSchedule schedule(pixels, spp, paths);
                std::vector<std::uint32_t> next(pixels, 0);
                std::uint64_t samples = 0;
                while (!schedule.finished()) {
                    const std::uint32_t most = 1 + random() % (2 * paths);
                    const Batch batch = schedule.next(most);
                    ASSERT_GE(batch.pixels * batch.samples, 1u);
                    ASSERT_LE(batch.pixels * batch.samples, std::min(most, paths));
                    ASSERT_LE(batch.first_pixel + batch.pixels, pixels);
                    for (std::uint32_t p = 0; p < batch.pixels; ++p) {
                        ASSERT_EQ(next[batch.first_pixel + p], batch.first_sample);
                        next[batch.first_pixel + p] += batch.samples;
                    }
                    samples += batch.pixels * batch.samples;
                    ASSERT_EQ(schedule.samples(), samples);
                    PassSchedule other(pixels, spp + 3, 77);  // another device continues
                    other.go_to(schedule.position());
                    ASSERT_EQ(other.samples(), samples);
                }
                for (const std::uint32_t count : next) ASSERT_EQ(count, spp);
                ASSERT_TRUE(schedule.between_passes());
            }
}

/// A noise limit stops between passes; their borders must not depend on the device's speed.
TEST(PassSchedule, PassesDoNotDependOnThePace) {
    const auto passes = [](std::uint32_t most) {
        PassSchedule schedule(100, 100, 1000);
        std::vector<std::uint32_t> ends;
        while (!schedule.finished()) {
            (void)schedule.next(most);
            if (schedule.between_passes()) ends.push_back(schedule.complete_passes_spp());
        }
        return ends;
    };
    EXPECT_EQ(passes(~0u), passes(1));
    EXPECT_EQ(passes(~0u), passes(333));
}

/// A device that takes so long for a path, and a while for a batch of any size.
class SimulatedDevice {
public:
    SimulatedDevice(double per_path, double per_batch) : per_path_(per_path), per_batch_(per_batch) {}
    [[nodiscard]] double milliseconds(std::uint32_t paths) const { return per_batch_ + per_path_ * paths; }

private:
    double per_path_, per_batch_;
};

TEST(Pace, BatchesTakeATenthOfASecondOnAnyDevice) {
    for (const double paths_a_second : {1e4, 1e5, 1e6, 1e7, 1e8, 1e9}) {
        const SimulatedDevice device(1e3 / paths_a_second, 1);
        Pace pace(16'384, 2'097'152);
        for (int batch = 0; batch < 20; ++batch) {
            const std::uint32_t paths = pace.paths();
            const double taken = device.milliseconds(paths);
            if (batch > 3) {
                EXPECT_LE(taken, 110) << paths_a_second;
            }
            pace.took(paths, taken);
        }
        const double taken = device.milliseconds(pace.paths());
        EXPECT_TRUE(pace.paths() == 2'097'152 || taken > 50) << paths_a_second << ": " << taken;
    }
}

TEST(Pace, ScenesThatGetHarderAreCutAtOnce) {
    Pace pace(1'000'000, 1'000'000);
    pace.took(1'000'000, 50);
    EXPECT_EQ(pace.paths(), 1'000'000u);
    pace.took(1'000'000, 400);
    EXPECT_EQ(pace.paths(), 250'000u);
    pace.took(1'000'000, 400);  // was under way already
    EXPECT_EQ(pace.paths(), 250'000u);
    pace.took(10, 1);  // the rest of an image says nothing
    EXPECT_EQ(pace.paths(), 250'000u);
    pace.took(10, 1e9);
    EXPECT_EQ(pace.paths(), 1u);
    pace.took(1, 0);
    EXPECT_EQ(pace.paths(), 4u);
}

TEST(Pace, AFewPathsTellLittleOfTheRest) {
    Pace pace(1'000'000, 1'000'000);
    EXPECT_EQ(pace.paths_within(10), 1'000'000u) << "nothing is known";
    EXPECT_EQ(pace.milliseconds_of(1000), 0.0);
    for (int i = 0; i < 3; ++i) pace.took(100'000, 50);
    EXPECT_NEAR(pace.milliseconds_of(1000), 0.5, 1e-9);
    pace.took(1000, 0.01);  // into the sky
    EXPECT_NEAR(pace.paths_within(10), 20'000, 200);
    for (int i = 0; i < 20; ++i) pace.took(100'000, 100);
    EXPECT_NEAR(pace.paths_within(10), 10'000, 200) << "what was long ago is forgotten";
}

}  // namespace
}  // namespace claray::test
