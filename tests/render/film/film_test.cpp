// The film: render/accumulate_film.cl, render/measure_film.cl and render/resolve_film.cl.
#include "host/render/film/film.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <tuple>

#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

/// Lognormal with standard deviation 2 of the logarithm: the largest of 16 M samples is some 10,000 times the mean.
float heavy_tailed(Random& random) {
    const double radius = std::sqrt(-2 * std::log(1 - double(random.uniform())));
    return float(std::exp(2 * radius * std::cos(6.283185307179586 * random.uniform())));
}

TEST(Film, SixteenMillionHeavyTailedSamplesSumAsInFloat64) {
    const std::uint32_t pixels = 2, per_batch = 1u << 18, batches = 64;
    Film film(device(), pixels);
    std::vector<double> exact(pixels);
    Random random(7);
    std::vector<float> radiance(3 * pixels * per_batch);
    for (std::uint32_t b = 0; b < batches; ++b) {
        for (std::uint32_t i = 0; i < pixels * per_batch; ++i) {
            const float value = heavy_tailed(random);
            exact[i / per_batch] += value;
            radiance[3 * i] = radiance[3 * i + 1] = radiance[3 * i + 2] = value;
        }
        film.accumulate({0, pixels, b * per_batch, per_batch, 0}, Buffer<float>(device(), radiance));
    }
    const std::vector<glm::vec3> image = film.image();
    for (std::uint32_t p = 0; p < pixels; ++p)
        EXPECT_NEAR(image[p].y / (exact[p] / (double(per_batch) * batches)), 1.0, 1e-6);
}

TEST(Film, SampleClampScalesBrightSamplesDown) {
    const std::vector<float> radiance{1, 2, 8, -16, 0, 4, 0, 0, 0, 3, 1, 2};
    Film film(device(), 1, 4.f);
    film.accumulate({0, 1, 0, 4, 0}, Buffer<float>(device(), radiance));
    EXPECT_EQ(film.image()[0], glm::vec3(0.5f + -4 + 0 + 3, 1 + 0 + 0 + 1, 4 + 1 + 0 + 2) / 4.f);
}

std::vector<float> random_radiance(std::uint32_t pixels, std::uint32_t samples, std::uint64_t seed) {
    Random random(seed);
    std::vector<float> radiance(3 * pixels * samples);
    for (float& value : radiance) value = heavy_tailed(random);
    return radiance;
}

TEST(Film, RadianceIsTheImageInAnySize) {
    Film film(device(), 12);
    std::vector<float> radiance(36);
    for (std::size_t i = 0; i < radiance.size(); ++i) radiance[i] = float(i * i);
    film.accumulate({0, 12, 0, 1, 0}, Buffer<float>(device(), radiance));
    for (const ImageSizes size : {ImageSizes{4, 3, 4, 3}, {4, 3, 9, 8}, {4, 3, 2, 2}}) {
        const std::vector<glm::vec3> image = film.image(size);
        ASSERT_EQ(image.size(), std::size_t(size.image_width) * size.image_height);
        const std::span<const glm::vec3> there = film.radiance(size);
        EXPECT_EQ(image, std::vector<glm::vec3>(there.begin(), there.end()));
        EXPECT_NE(image.back(), glm::vec3(0));
    }
    EXPECT_EQ(film.radiance({4, 3, 4, 3})[11], glm::vec3(33 * 33, 34 * 34, 35 * 35));
}

TEST(Film, BatchesOfAnySizeGiveTheSameBits) {
    const std::uint32_t pixels = 37, samples = 24;
    const std::vector<float> radiance = random_radiance(pixels, samples, 3);
    Film whole(device(), pixels), parts(device(), pixels);
    whole.accumulate({0, pixels, 0, samples, 0}, Buffer<float>(device(), radiance));
    for (std::uint32_t s = 0; s < samples; s += 8)
        for (std::uint32_t p = 0; p < pixels; ++p) {
            const auto begin = radiance.begin() + 3 * (p * samples + s);
            parts.accumulate({p, 1, s, 8, 0}, Buffer<float>(device(), std::vector<float>(begin, begin + 24)));
        }
    const std::vector<glm::vec3> a = whole.image(), b = parts.image();
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

/// clear() leaves the memory as it is: batches overwrite it, in order or not, and readers see 0 elsewhere.
TEST(Film, HoldsNoSampleThatIsOlderThanItsClearing) {
    const std::uint32_t pixels = 12, half = 6;
    const Buffer<float> old(device(), random_radiance(pixels, 2, 1));
    const Buffer<float> radiance(device(), random_radiance(half, 2, 2));
    for (const std::uint32_t first : {0u, half}) {
        Film used(device(), pixels), fresh(device(), pixels);
        used.accumulate({0, pixels, 0, 2, 0}, old);
        used.clear();
        for (Film* film : {&used, &fresh}) film->accumulate({first, half, 0, 2, 0}, radiance);
        const std::vector<FilmPixel> a = used.sums(), b = fresh.sums();
        EXPECT_EQ(std::memcmp(a.data(), b.data(), pixels * sizeof(FilmPixel)), 0);
        for (std::uint32_t p = 0; p < pixels; ++p) EXPECT_EQ(b[p].count, p >= first && p < first + half ? 2u : 0u);
    }
    Film used(device(), pixels);
    used.accumulate({0, pixels, 0, 2, 0}, old);
    used.clear();
    EXPECT_EQ(used.image(), std::vector<glm::vec3>(pixels, glm::vec3(0)));
}

TEST(Film, NoiseOfIndependentSamplesIsTheirStandardError) {
    const std::uint32_t pixels = 20'000;
    for (const std::uint32_t samples : {2u, 5u, 32u}) {
        Random random(samples);
        std::vector<float> radiance(3 * pixels * samples);
        for (std::size_t i = 0; i < radiance.size(); i += 3)
            radiance[i] = radiance[i + 1] = radiance[i + 2] = random.uniform();
        Film film(device(), pixels);
        film.accumulate({0, pixels, 0, samples, 0}, Buffer<float>(device(), radiance));
        const double expected = std::sqrt(1.0 / 12 / samples) / 0.5;
        EXPECT_NEAR(film.noise().relative / expected, 1.0, 0.03) << samples << " samples";
    }
}

TEST(Film, NoiseHasNoUnit) {
    const std::uint32_t pixels = 64, samples = 8;
    std::vector<float> radiance = random_radiance(pixels, samples, 5);
    Film film(device(), pixels);
    film.accumulate({0, pixels, 0, samples, 0}, Buffer<float>(device(), radiance));
    const double noise = film.noise().relative;
    EXPECT_GT(noise, 0);
    for (const float unit : {0x1p-80f, 0x1p80f}) {
        std::vector<float> other = radiance;
        for (float& value : other) value *= unit;
        film.clear();
        film.accumulate({0, pixels, 0, samples, 0}, Buffer<float>(device(), other));
        EXPECT_NEAR(film.noise().relative, noise, 1e-6 * noise) << unit;
    }
}

TEST(Film, NoiseIsUnknownAfterOneSample) {
    Film film(device(), 4);
    film.accumulate({0, 4, 0, 1, 0}, Buffer<float>(device(), random_radiance(4, 1, 1)));
    EXPECT_EQ(film.noise().relative, 0.0);
}

/// A pixel that begins with one sample is not summed; one that was begun without samples is.
TEST(Film, OneSampleIsTheSumOfItself) {
    const std::uint32_t pixels = 77;
    const float inf = std::numeric_limits<float>::infinity();
    std::vector<float> values = random_radiance(pixels, 1, 3);
    values[3] = NAN, values[7] = inf, values[3 * 70 + 2] = -2e30f, values[12] = -3, values[15] = 0, values[16] = 1e-40f;
    const Buffer<float> radiance(device(), values);
    for (const std::uint32_t number : {0u, 1u}) {
        for (const float limit : {0.f, 2.f}) {
            Film one(device(), pixels, limit), summed(device(), pixels, limit);
            (void)summed.pixels();
            for (Film* film : {&one, &summed}) film->accumulate({0, pixels, number, 1, 0}, radiance);
            const std::vector<FilmPixel> a = one.sums(), b = summed.sums();
            EXPECT_EQ(std::memcmp(a.data(), b.data(), pixels * sizeof(FilmPixel)), 0) << number;
            EXPECT_EQ(one.noise().dropped, 3u);
            EXPECT_EQ(summed.noise().dropped, 3u);
        }
    }
}

/// Without a look at the pixels as long as they have one sample each.
TEST(Film, CountsDroppedSamplesOfFrames) {
    const std::uint32_t pixels = 70;
    std::vector<float> values = random_radiance(pixels, 1, 4);
    values[0] = values[100] = values[101] = NAN;
    const Buffer<float> bad(device(), values), good(device(), random_radiance(pixels, 1, 5));
    Film film(device(), pixels);
    film.accumulate({0, 40, 0, 1, 0}, bad);
    EXPECT_EQ(film.noise().dropped, 2u);
    film.clear();
    EXPECT_EQ(film.noise().dropped, 0u);
    film.accumulate({0, pixels, 0, 1, 0}, good);
    EXPECT_EQ(film.noise().dropped, 0u);
    film.accumulate({0, pixels, 1, 1, 0}, bad);
    EXPECT_EQ(film.noise().dropped, 2u);
    EXPECT_GT(film.noise().relative, 0.0);
}

/// Groups that are not full, and items that have several pixels, against sums in float64.
TEST(Film, SumsUpAllPixels) {
    for (const std::uint32_t pixels : {1u, 255u, 777u, CLARAY_SUM_ITEMS + 300u}) {
        constexpr std::uint32_t samples = 4;
        const std::vector<float> radiance = random_radiance(pixels, samples, 5);
        Film film(device(), pixels);
        film.accumulate({0, pixels, 0, samples, 0}, Buffer<float>(device(), radiance));
        double variance = 0, luminance = 0;
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            double halves[2] = {};
            for (std::size_t i = 0; i < samples; ++i) {
                const float* const rgb = &radiance[3 * (pixel * samples + i)];
                halves[i % 2] += (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) / (samples / 2.0);
            }
            variance += std::pow(halves[0] - halves[1], 2) / 4, luminance += (halves[0] + halves[1]) / 2;
        }
        const double expected = std::sqrt(variance / pixels) / (luminance / pixels);
        EXPECT_NEAR(film.noise().relative / expected, 1, 1e-4) << pixels;
    }
}

TEST(Film, NoiseDoesNotDependOnTheBatches) {
    const std::uint32_t pixels = 37, samples = 24;
    const std::vector<float> radiance = random_radiance(pixels, samples, 3);
    Film whole(device(), pixels), parts(device(), pixels);
    whole.accumulate({0, pixels, 0, samples, 0}, Buffer<float>(device(), radiance));
    for (std::uint32_t p = 0; p < pixels; ++p)
        for (std::uint32_t s = 0, n = 1; s < samples; s += n, n = std::min(samples - s, n + 1)) {
            const auto begin = radiance.begin() + 3 * (p * samples + s);
            parts.accumulate({p, 1, s, n, 0}, Buffer<float>(device(), std::vector<float>(begin, begin + 3 * n)));
        }
    EXPECT_GT(whole.noise().relative, 0);
    EXPECT_EQ(whole.noise().relative, parts.noise().relative);
    EXPECT_EQ(whole.noise_map(), parts.noise_map());
}

TEST(Film, NoiseLeavesOutSamplesThatWereDropped) {
    Film film(device(), 1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    film.accumulate({0, 1, 0, 6, 0},
                    Buffer<float>(device(), {4, 4, 4, 8, 8, 8, 4, 4, 4, nan, 1, 1, 4, 4, 4, nan, 1, 1}));
    EXPECT_EQ(film.image()[0], glm::vec3(5));
    EXPECT_NEAR(film.noise().relative, std::sqrt(16. * 3 / 16) / 5, 1e-6);
    EXPECT_EQ(film.noise().dropped, 2u);
}

}  // namespace
}  // namespace claray::test
