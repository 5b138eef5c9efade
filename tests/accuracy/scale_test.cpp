// Size and samples of studies by the speed of the device. Times are not tested, since the machine may be busy.
#include <gtest/gtest.h>

#include <bit>

#include "claray/accuracy.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

/// So long that a busy machine takes no less for a thousand paths.
constexpr StudyScale long_ones{.seconds = 0.3};

/// With kernels that other tests of this folder use, too.
StudyOptions options_of(unsigned side) {
    return {.config = {.width = side, .height = side / 2, .effects = {.add = full_effects(), .remove = {}}}};
}

TEST(Scale, GrowsSamplesWhereTheSizeIsGiven) {
    const StudyOptions given = options_of(16);
    const StudyOptions scaled = at_scale(device(), *builtin_scene("cornell"), given, true, false, true, long_ones);
    EXPECT_EQ(scaled.config.width, 16u);
    EXPECT_EQ(scaled.config.height, 8u);
    EXPECT_GT(scaled.first_spp, 8u) << "no device takes as long for 1024 paths";
    EXPECT_TRUE(std::has_single_bit(scaled.first_spp));
    EXPECT_EQ(scaled.most_spp, 128 * scaled.first_spp) << "two decades";
    EXPECT_EQ(scaled.single_spp, 4 * scaled.first_spp);
    EXPECT_EQ(scaled.compared_spp, 16 * scaled.first_spp);
    EXPECT_EQ(scaled.reference_renders, scaled.reference_factor) << "each of as many samples as the largest setting";
    EXPECT_GE(scaled.most_seconds, scaled.least_seconds);
    EXPECT_EQ(scaled.rays, given.rays);
}

TEST(Scale, GrowsTheImageWhereTheSamplesAreGiven) {
    StudyOptions given = options_of(16);
    given.most_spp = 256;
    const StudyOptions scaled = at_scale(device(), *builtin_scene("cornell"), given, false, true, false, long_ones);
    EXPECT_EQ(scaled.most_spp, 256u);
    EXPECT_EQ(scaled.first_spp, 2u);
    EXPECT_EQ(scaled.single_spp, 0u) << "studies of one number of samples take those that were given";
    EXPECT_EQ(scaled.reference_factor, given.reference_factor);
    EXPECT_GT(scaled.config.width, 32u);
    EXPECT_LE(scaled.config.width, 1024u);
    EXPECT_EQ(scaled.config.width, 2 * scaled.config.height) << "the same view";
    EXPECT_GE(scaled.rays, given.rays);
}

TEST(Scale, IsWhatWasAskedFor) {
    const StudyOptions scaled = at_scale(device(), *builtin_scene("cornell"), options_of(64), false, false, true,
                                         {.seconds = 1e-9, .span = 32});
    EXPECT_EQ(scaled.config.width, 64u) << "an image of fewer columns shows little";
    EXPECT_EQ(scaled.first_spp, 1u);
    EXPECT_EQ(scaled.most_spp, 32u);
    EXPECT_EQ(scaled.compared_spp, 16u);
    EXPECT_EQ(scaled.least_seconds, 1e-9);
}

}  // namespace
}  // namespace claray::test
