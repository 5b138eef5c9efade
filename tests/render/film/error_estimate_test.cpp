// What control pixels tell of an image's error (host/render/film/error_estimate.cpp), of images with known errors.
#include "host/render/film/error_estimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace claray::test {
namespace {

constexpr std::uint32_t width = 96, height = 64, pixels = width * height;

/// The means of the halves of a pixel's samples, less what is true.
struct Halves {
    double a, b;
};
struct SyntheticImage {
    const char* name;
    Halves (*draw)(std::mt19937& random, std::uint32_t pixel);
};

double normal(std::mt19937& random) { return std::normal_distribution<double>()(random); }

constexpr SyntheticImage images[] = {
    {"even noise",
     [](std::mt19937& r, std::uint32_t) {
         return Halves{0.1 * normal(r), 0.1 * normal(r)};
     }},
    {"a noisy corner",
     [](std::mt19937& r, std::uint32_t p) {
         const double size = p % width < 8 && p / width < 8 ? 3 : 0.05;
         return Halves{size * normal(r), size * normal(r)};
     }},
    {"halves that complete each other",
     [](std::mt19937& r, std::uint32_t) {
         const double between = 0.5 * normal(r), common = 0.05 * normal(r);
         return Halves{common + between, common - between};
     }},
    {"halves that go astray together",
     [](std::mt19937& r, std::uint32_t) {
         const double between = 0.02 * normal(r), common = 0.1 * normal(r);
         return Halves{common + between, common - between};
     }},
};

/// An image of true radiance 1 everywhere, and what a renderer knows of it.
struct Rendered {
    std::vector<glm::vec3> image;
    std::vector<float> variances, expected;
    std::vector<ControlPixel> controls;
    double square = 0;  // of the true error
};

Rendered rendered(const SyntheticImage& of, std::mt19937& random) {
    Rendered r;
    for (std::uint32_t p = 0; p < pixels; ++p) {
        const Halves h = of.draw(random, p);
        r.image.emplace_back(float(1 + (h.a + h.b) / 2));
        r.variances.push_back(float(std::pow((h.a - h.b) / 2, 2)));
        r.square += std::pow((h.a + h.b) / 2, 2) / pixels;
    }
    r.expected = expected_variances(r.variances, width);
    r.controls = pick_control_pixels(r.expected, random());
    for (ControlPixel& control : r.controls) {
        const Halves h = of.draw(random, control.pixel);
        const auto value = float(2 + h.a + h.b);
        control.sums.all.r = control.sums.all.g = control.sums.all.b = value, control.sums.count = 2;
    }
    return r;
}

ErrorEstimate estimate_of(const Rendered& r) { return estimate_error(r.image, r.variances, r.expected, r.controls); }

TEST(ErrorEstimate, IsTheErrorHoweverTheHalvesOfTheSamplesComplementEachOther) {
    std::mt19937 random(3);
    for (const SyntheticImage& image : images) {
        constexpr int trials = 150;
        int held = 0;
        double estimated = 0, actual = 0, bounds = 0;
        for (int t = 0; t < trials; ++t) {
            const Rendered r = rendered(image, random);
            ErrorProgress progress;
            progress.add(estimate_of(r), 64);
            estimated += progress.last.square, actual += r.square, bounds += progress.bound();
            held += r.square <= progress.bound();
            EXPECT_LT(progress.last.fireflies, 0.05) << image.name;
        }
        EXPECT_NEAR(estimated / actual, 1, 0.05) << image.name;
        EXPECT_GE(held, trials * 96 / 100) << image.name;
        EXPECT_LT(std::sqrt(bounds / actual), 1.25) << image.name;
    }
}

TEST(ErrorEstimate, TellsFirefliesApart) {
    std::mt19937 random(4);
    const SyntheticImage fireflies{"fireflies", [](std::mt19937& r, std::uint32_t) {
                                       return Halves{0.01 * normal(r) + (r() % 4000 == 0 ? 8 : 0), 0.01 * normal(r)};
                                   }};
    double estimated = 0, actual = 0;
    for (int t = 0; t < 50; ++t) {
        const Rendered r = rendered(fireflies, random);
        const ErrorEstimate estimate = estimate_of(r);
        estimated += estimate.square, actual += r.square;
        if (r.square > 1e-3) {
            EXPECT_GT(estimate.fireflies, 0.2);
        }
    }
    EXPECT_NEAR(estimated / actual, 1, 0.2);
}

TEST(ErrorEstimate, OfABlackImageOrOneWithoutControlPixelsIsUnknown) {
    std::mt19937 random(5);
    Rendered r = rendered(images[0], random);
    EXPECT_EQ(estimate_error(r.image, r.variances, r.expected, {}).square, 0);
    std::ranges::fill(r.image, glm::vec3(0));
    EXPECT_EQ(estimate_of(r).square, 0);
    EXPECT_EQ(ErrorProgress().bound(), 0);
}

TEST(ErrorIntervals, HoldTheTruthInNineteenOfTwentyPixels) {
    std::mt19937 random(6);
    for (const SyntheticImage& image : images) {
        double within = 0;
        constexpr int trials = 40;
        for (int t = 0; t < trials; ++t) {
            const Rendered r = rendered(image, random);
            const std::vector<float> widths = error_intervals(r.image, r.variances, r.expected, r.controls);
            for (std::uint32_t p = 0; p < pixels; ++p) within += std::abs(r.image[p].x - 1) <= widths[p];
        }
        EXPECT_NEAR(within / (trials * double(pixels)), 0.95, 0.01) << image.name;
    }
}

TEST(ControlPixels, ArePickedWithTheirChances) {
    std::vector<float> expected(pixels, 1.f);
    for (std::uint32_t p = 0; p < 100; ++p) expected[p] = 100;
    expected[3000] = 1e6;
    std::vector<int> picked(pixels);
    std::vector<double> chances(pixels);
    constexpr int trials = 2000;
    for (int t = 0; t < trials; ++t)
        for (const ControlPixel& control : pick_control_pixels(expected, std::uint32_t(t)))
            ++picked[control.pixel], chances[control.pixel] = double(control.chance);
    EXPECT_EQ(picked[3000], trials);
    EXPECT_EQ(chances[3000], 1);
    EXPECT_NEAR(std::accumulate(picked.begin(), picked.end(), 0.0) / trials, 1024, 1);
    double worst = 0;
    for (std::uint32_t p = 0; p < pixels; ++p) {
        const double wide = std::sqrt(chances[p] * (1 - chances[p]) / trials) + 1e-9;
        worst = std::max(worst, std::abs(picked[p] / double(trials) - chances[p]) / wide);
    }
    EXPECT_LT(worst, 5) << "standard errors";
    EXPECT_EQ(pick_control_pixels(std::vector<float>(100, 1.f), 1).size(), 100u) << "all of a small image";
}

/// As a mean over the pixels around, also at borders.
TEST(ControlPixels, ExpectTheVarianceOfTheirNeighbours) {
    std::vector<float> variances(pixels, 1.f);
    for (const float v : expected_variances(variances, width)) EXPECT_EQ(v, 1.f);
    for (const std::uint32_t firefly : {0u, 20 * width + 30, pixels - 1}) {
        variances[firefly] = 1e6f;
        const std::vector<float> expected = expected_variances(variances, width);
        EXPECT_LT(expected[firefly], 8.f) << "it is not expected of its neighbours";
        EXPECT_EQ(expected[10 * width + 10], 1.f);
        variances[firefly] = 1;
    }
}

ErrorProgress progress_after(std::uint32_t spp, double square) {
    ErrorProgress progress;
    progress.add({square, 0, 0}, spp);
    return progress;
}

TEST(ErrorProgress, TheNextLookIsWhereTheErrorIsReachedIfItFallsAsItDid) {
    EXPECT_EQ(ErrorProgress().next(1), 4u) << "the first";
    EXPECT_EQ(progress_after(1000, 1).next(1.0001), 1000u) << "they suffice";
    EXPECT_EQ(progress_after(1000, 1).next(0.9999), 1063u) << "a sixteenth more at least";
    EXPECT_EQ(progress_after(1000, 1).next(0.1), 2000u) << "twice as many at most";
    EXPECT_EQ(progress_after(1000, 1.5).next(1), 1500u) << "as independent samples";
    ErrorProgress fast = progress_after(500, std::pow(2, 1.25) * 1.5);
    fast.add({1.5, 0, 0}, 1000);
    EXPECT_NEAR(fast.next(1), 1000 * std::pow(1.5, 1 / 1.25), 1);
    EXPECT_EQ(progress_after(600, 1.5).next(1), 1024u) << "instead of 900: a power of two is near";
}

}  // namespace
}  // namespace claray::test
