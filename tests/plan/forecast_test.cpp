// What is foreseen of renders to an error, against renders whose errors and times follow a law.
#include "host/plan/forecast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace claray::test {
namespace {

/// The squared error falls as the samples to a power; a sample takes 0.1 s, those before `own_from` 1 s.
struct LawfulRender {
    double power = 1, bound_over_error = 1.5;
    unsigned own_from = 0;

    [[nodiscard]] RenderProgress at(unsigned spp) const {
        RenderProgress report;
        report.spp = report.error_spp = spp;
        report.own_kernels = spp >= own_from;
        report.seconds = 1.0 * std::min(spp, own_from) + 0.1 * (spp - std::min(spp, own_from));
        report.error = std::pow(double(spp), -power / 2);
        report.error_bound = bound_over_error * report.error;
        return report;
    }
    /// Samples for a bound, by the law.
    [[nodiscard]] double needed(double bound) const { return std::pow(bound_over_error / bound, 2 / power); }
};

TEST(Forecast, IsTheLawOfIndependentSamplesAfterAnySamples) {
    const LawfulRender render;
    Watched watched;
    for (const unsigned spp : {16u, 32u, 64u, 1024u}) {
        const auto forecast = watched.foresee(render.at(spp), 0.01, 0);
        ASSERT_TRUE(forecast) << spp;
        EXPECT_NEAR(forecast->spp, render.needed(0.01), 1e-6 * forecast->spp);
        EXPECT_NEAR(forecast->seconds_a_sample, 0.1, 1e-9);
        EXPECT_NEAR(forecast->seconds, 0.1 * render.needed(0.01), 1e-6 * forecast->seconds);
    }
}

TEST(Forecast, BelievesFasterConvergenceOnceSamplesAreFourTimesAsMany) {
    const LawfulRender sobol{.power = 1.3};
    Watched watched;
    for (const unsigned spp : {16u, 63u}) {
        const double times = std::pow(sobol.at(spp).error_bound / 0.001, 2);
        EXPECT_NEAR(watched.foresee(sobol.at(spp), 0.001, 0)->spp, spp * times, 1e-6 * spp * times);
    }
    for (const unsigned spp : {64u, 4096u})
        EXPECT_NEAR(watched.foresee(sobol.at(spp), 0.001, 0)->spp / sobol.needed(0.001), 1, 1e-6);
}

/// Luck is not: neither errors that fall faster than Sobol's at edges nor errors that do not fall.
TEST(Forecast, BelievesNoOtherConvergence) {
    for (const double power : {3.0, 0.2}) {
        const LawfulRender render{.power = power};
        Watched watched;
        (void)watched.foresee(render.at(16), 1e-5, 0);
        const double believed = power > 1 ? 1.5 : 1, times = std::pow(render.at(256).error_bound / 1e-5, 2 / believed);
        EXPECT_NEAR(watched.foresee(render.at(256), 1e-5, 0)->spp, 256 * times, 1e-6 * 256 * times);
    }
}

/// The kernels that a render begins with are slow ones.
TEST(Forecast, GoesByThePaceOfTheScenesOwnKernels) {
    const LawfulRender render{.own_from = 20};
    Watched watched;
    EXPECT_FALSE(watched.foresee(render.at(16), 0.01, 0));
    EXPECT_TRUE(watched.foresee(render.at(20), 0.01, 0)) << "by all that is known: a second a sample";
    EXPECT_FALSE(watched.foresee(render.at(40), 0.01, 3)) << "watched for 2 s";
    const auto forecast = watched.foresee(render.at(60), 0.01, 3);
    ASSERT_TRUE(forecast);
    EXPECT_NEAR(forecast->seconds_a_sample, 0.1, 1e-9);
    EXPECT_NEAR(forecast->seconds, 20 + 0.1 * (render.needed(0.01) - 20), 1e-6 * forecast->seconds);
}

TEST(Forecast, NeedsSixteenSamplesAndAnError) {
    const LawfulRender render;
    Watched watched;
    EXPECT_FALSE(watched.foresee(render.at(15), 0.01, 0));
    RenderProgress unknown = render.at(100);
    unknown.error_bound = unknown.error = 0;
    EXPECT_FALSE(watched.foresee(unknown, 0.01, 0));
}

/// What is reached already needs no more samples.
TEST(Forecast, IsNeverBehindTheRender) {
    const LawfulRender render;
    Watched watched;
    const auto forecast = watched.foresee(render.at(1000), 0.5, 0);
    ASSERT_TRUE(forecast);
    EXPECT_EQ(forecast->spp, 1000);
    EXPECT_EQ(forecast->seconds, render.at(1000).seconds);
}

}  // namespace
}  // namespace claray::test
