// Adaptive sampling: which pixels get how many samples, and what it gains.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "host/render/schedule/adaptive_schedule.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

constexpr unsigned width = 37, height = 21;  // tiles at two borders are parts

constexpr unsigned columns = (width + 7) / 8, rows = (height + 7) / 8;

std::size_t half_of(std::size_t x, std::size_t y) { return 2 * (y / 8 * columns + x / 8) + (x + y) % 2; }

/// The mean of each half tile.
std::vector<float> means_of_halves(const std::vector<float>& values) {
    std::vector<float> means(2 * columns * rows), pixels(means.size());
    for (std::size_t p = 0; p < values.size(); ++p) {
        const std::size_t half = half_of(p % width, p / width);
        means[half] += values[p], ++pixels[half];
    }
    for (std::size_t h = 0; h < means.size(); ++h) means[h] /= std::max(pixels[h], 1.f);
    return means;
}

/// The mean variance of each half tile's pixels after these samples, if it falls with their number: the left eighth has
/// most of it.
std::vector<float> variances_after(const std::vector<std::uint32_t>& samples) {
    std::vector<float> variances(samples.size());
    for (std::size_t p = 0; p < samples.size(); ++p) variances[p] = (p % width < 5 ? 100.f : 0.01f) / float(samples[p]);
    return means_of_halves(variances);
}

/// The list of a round, two words per entry.
std::vector<std::uint32_t> list_of(const AdaptiveSchedule::Round& round) {
    std::vector<std::uint32_t> list;
    for (std::size_t r = 0; r < round.halves.size(); r += 3) {
        EXPECT_EQ(round.halves[r + 2], list.size() / 2);
        for (unsigned p = 0; p < width * height; ++p)
            if (half_of(p % width, p / width) == round.halves[r])
                for (std::uint32_t i = 0; i < round.halves[r + 1]; i += round.unit)
                    list.push_back(p), list.push_back(round.halves[r + 1] + i);
    }
    EXPECT_EQ(round.entries, list.size() / 2);
    return list;
}

/// Takes the next batch; checks that each of its pixels gets the samples that follow the ones it has.
void take(AdaptiveSchedule& schedule, std::uint32_t most, std::vector<std::uint32_t>& samples) {
    if (schedule.wants_plan()) schedule.plan(variances_after(samples));
    if (schedule.finished()) return;
    const std::vector<std::uint32_t> listed = list_of(schedule.round());
    const Batch batch = schedule.next(most);
    ASSERT_GE(batch.pixels * batch.samples, 1u);
    ASSERT_LE(batch.pixels * batch.samples, std::max(most, 1u));
    for (std::uint32_t i = batch.first_pixel; i < batch.first_pixel + batch.pixels; ++i) {
        const std::uint32_t pixel = batch.listed ? listed.at(2 * i) : i;
        ASSERT_EQ(samples.at(pixel), batch.first_sample + (batch.listed ? listed.at(2 * i + 1) : 0));
        samples[pixel] += batch.samples;
    }
}

std::vector<std::uint32_t> all_samples(std::uint32_t spp, std::uint32_t most) {
    AdaptiveSchedule schedule(width, height, spp, 1000, true);
    std::vector<std::uint32_t> samples(width * height);
    while (!schedule.finished()) {
        take(schedule, most, samples);
        if (testing::Test::HasFatalFailure()) break;
        std::uint64_t all = 0;
        for (const std::uint32_t n : samples) all += n;
        EXPECT_EQ(schedule.samples(), all);
    }
    return samples;
}

TEST(AdaptiveSchedule, SpendsTheSamplesWhereTheyPay) {
    for (const std::uint32_t spp : {1u, 15u, 16u, 17u, 64u, 300u}) {
        const std::vector<std::uint32_t> samples = all_samples(spp, ~0u);
        double sum = 0;
        std::uint32_t least = ~0u, most = 0;
        for (const std::uint32_t n : samples) sum += n, least = std::min(least, n), most = std::max(most, n);
        EXPECT_LE(sum, double(spp) * width * height);
        EXPECT_GE(sum, 0.97 * spp * width * height - 16 * 64) << spp;
        EXPECT_GE(16 * least, spp);
        EXPECT_TRUE(spp > 16 || least == most) << spp;
        EXPECT_TRUE(spp < 64 || (samples[2] == most && most >= 8 * least)) << spp;
        for (const std::uint32_t n : samples) EXPECT_TRUE(spp < 16 || least == most || std::has_single_bit(n)) << n;
    }
}

TEST(AdaptiveSchedule, DoesNotDependOnTheBatches) {
    const std::vector<std::uint32_t> whole = all_samples(100, ~0u);
    for (const std::uint32_t most : {5u, 64u, 777u}) EXPECT_EQ(all_samples(100, most), whole) << most;
}

TEST(AdaptiveSchedule, GoesOnFromEveryPosition) {
    AdaptiveSchedule schedule(width, height, 60, 1000, true);
    std::vector<std::uint32_t> samples(width * height);
    while (!schedule.finished()) {
        take(schedule, 900, samples);
        AdaptiveSchedule other(width, height, 60, 777, true);
        ASSERT_TRUE(other.go_to(schedule.position()));
        ASSERT_EQ(other.samples(), schedule.samples());
        ASSERT_EQ(other.round(), schedule.round());
    }
    EXPECT_EQ(samples, all_samples(60, ~0u));
}

TEST(AdaptiveSchedule, SamplesTheWholeImageWhileTheErrorIsSpreadEvenly) {
    for (const std::uint32_t spp : {17u, 64u, 100u}) {
        AdaptiveSchedule schedule(width, height, spp, 1000, true);
        std::uint32_t plans = 0;
        for (; !schedule.finished(); (void)schedule.next(700)) {
            if (schedule.wants_plan()) schedule.plan(std::vector<float>(30, 1.f)), ++plans;
            ASSERT_FALSE(schedule.has_rounds() || schedule.in_round());
            AdaptiveSchedule other(width, height, spp, 1000, true);
            ASSERT_TRUE(other.go_to(schedule.position()));
            ASSERT_EQ(other.samples(), schedule.samples());
            ASSERT_EQ(other.finished(), schedule.finished());
        }
        EXPECT_EQ(schedule.samples(), std::uint64_t(spp) * width * height);
        EXPECT_EQ(plans, spp == 17 ? 1u : spp == 64 ? 2u : 3u);
    }
}

/// Chosen by its own samples, a pixel whose first samples missed a light would get fewer, and its mean would be too
/// small.
TEST(AdaptiveSchedule, DoesNotChooseAPixelByItsOwnSamples) {
    const auto chosen = [](float own) {  // of the first tile's first half, among halves of little noise
        AdaptiveSchedule schedule(width, height, 64, 1000, true, 0);
        std::vector<float> variances(2 * columns * rows);
        for (std::size_t h = 0; h < variances.size(); ++h)
            variances[h] = h == 0 ? own : h / 2 % columns == columns - 1 ? 20.f : 1.f;
        while (!schedule.wants_plan()) (void)schedule.next();
        schedule.plan(variances);
        std::vector<bool> halves(variances.size());
        for (std::size_t r = 0; r < schedule.round().halves.size(); r += 3) halves[schedule.round().halves[r]] = true;
        return std::pair(bool(halves[0]), bool(halves[1]));
    };
    EXPECT_EQ(chosen(1e-3f), std::pair(false, false));
    EXPECT_EQ(chosen(1e3f), std::pair(false, true));
}

/// Fireflies and the edge of a lamp are in few tiles, glass is in many.
TEST(AdaptiveSchedule, BeginsNoRoundsForFewTiles) {
    for (const auto& [bright, begins] : {std::pair{8u, false}, std::pair{80u, true}}) {
        AdaptiveSchedule schedule(160, 160, 256, 100'000, true);
        std::vector<float> variances(800, 1.f);
        std::fill_n(variances.begin() + 77, bright, 1e4f);
        while (!schedule.finished() && !schedule.has_rounds()) {
            if (schedule.wants_plan()) schedule.plan(variances);
            if (!schedule.finished()) (void)schedule.next();
        }
        EXPECT_EQ(schedule.has_rounds(), begins) << bright;
    }
}

/// render/measure_film.cl
TEST(AdaptiveSchedule, WeighsNoiseByTheBrightnessAndByHalvesOfTiles) {
    std::vector<FilmPixel> film(width * height);
    std::vector<float> expected(film.size());
    for (std::size_t p = 0; p < film.size(); ++p) {
        const float even = 1.f + float(p * 37 % 11), odd = float(p * 53 % 13);
        film[p] = {};
        film[p].all.r = film[p].all.g = film[p].all.b = even + odd;
        film[p].odd_sum = odd, film[p].count = 2, film[p].odd_count = 1;
        expected[p] = (even - odd) * (even - odd) / 4 / std::sqrt((even + odd) / 2 + 0.05f);
    }
    const Buffer<float> found(device(), 2 * columns * rows);
    load_kernel(device(), "render/measure_film.cl", "map_gain")
        .run({2 * columns * rows, 64}, Buffer<FilmPixel>(device(), film), width, height, 1.f, found);
    const std::vector<float> halves = found.read(), means = means_of_halves(expected);
    for (std::size_t h = 0; h < means.size(); ++h) EXPECT_NEAR(halves[h], means[h], 1e-4f * means[h]) << h;
}

/// render/measure_film.cl
TEST(AdaptiveSchedule, IsListedOnTheDevice) {
    AdaptiveSchedule schedule(width, height, 300, 1000, true);
    std::vector<std::uint32_t> samples(width * height);
    std::size_t rounds = 0;
    for (; !schedule.finished(); take(schedule, ~0u, samples)) {
        if (schedule.wants_plan()) schedule.plan(variances_after(samples));
        if (!schedule.in_round()) continue;
        const AdaptiveSchedule::Round& round = schedule.round();
        const std::vector<std::uint32_t> expected = list_of(round);
        Buffer<std::uint32_t> tables(device(), expected.size() + 2);
        tables.fill(7);
        const auto count = std::uint32_t(round.halves.size() / 3);
        load_kernel(device(), "render/measure_film.cl", "list_pixels")
            .run({64 * count, 64}, arg("halves", Buffer<std::uint32_t>(device(), round.halves)), count, width, height,
                 round.unit, arg("tables", tables), 1u);
        std::vector<std::uint32_t> found = tables.read();
        EXPECT_TRUE(found.front() == 7 && found.back() == 7);
        EXPECT_EQ(std::vector(found.begin() + 1, found.end() - 1), expected);
        ++rounds;
    }
    EXPECT_GT(rounds, 3u);
}

TEST(AdaptiveSchedule, RefusesPositionsThatDoNotExist) {
    AdaptiveSchedule schedule(width, height, 60, 1000, true);
    std::vector<std::uint32_t> samples(width * height);
    while (!schedule.in_round() && !schedule.finished()) take(schedule, 1000, samples);
    ASSERT_TRUE(schedule.in_round());
    const AdaptiveSchedule::Position good = schedule.position();
    const auto accepts = [](const AdaptiveSchedule::Position& position) {
        return AdaptiveSchedule(width, height, 60, 1000, true).go_to(position);
    };
    ASSERT_TRUE(accepts(good));
    EXPECT_FALSE(AdaptiveSchedule(width, height, 60, 1000, false).go_to(good));
    EXPECT_FALSE(AdaptiveSchedule(width, height, 17, 1000, true).go_to({{0, 0, 0, 0}, std::vector(30u, 32u)}));
    for (auto change : {+[](AdaptiveSchedule::Position& p) { p.at.sample = 99; },
                        +[](AdaptiveSchedule::Position& p) { p.halves.pop_back(); },
                        +[](AdaptiveSchedule::Position& p) { p.halves[0] = 17; },
                        +[](AdaptiveSchedule::Position& p) { p.halves[0] = 0; },
                        +[](AdaptiveSchedule::Position& p) { p.at.done = 99; },
                        +[](AdaptiveSchedule::Position& p) { p.at.pixel = 1u << 20; }}) {
        AdaptiveSchedule::Position bad = good;
        change(bad);
        EXPECT_FALSE(accepts(bad));
    }
}

/// Two renders of the same seed by other batches, and the error against many samples: most of it is at the borders of
/// the lamp and of shadows.
TEST(AdaptiveSampling, HasLessErrorForAsManySamplesAndTheSameMean) {
    const Scene scene = *builtin_scene("cornell");
    const auto image = [&](unsigned spp, unsigned seed, bool adaptive) {
        return render_by_own_kernels(scene,
                                     {.width = 64, .height = 64, .spp = spp, .seed = seed, .adaptive = adaptive});
    };
    const std::vector<glm::vec3> reference = image(512, 77, false);
    double square[2] = {0, 0}, means[2] = {0, 0};
    for (unsigned seed = 1; seed <= 8; ++seed)
        for (const bool adaptive : {false, true}) {
            const std::vector<glm::vec3> rendered = image(64, seed, adaptive);
            for (std::size_t p = 0; p < rendered.size(); ++p) {
                const glm::vec3 d = rendered[p] - reference[p];
                square[adaptive] += double(glm::dot(d, d));
            }
            means[adaptive] += mean(rendered).y / 8;
        }
    EXPECT_GT(square[0], 1.3 * square[1]);
    EXPECT_NEAR(means[1] / means[0], 1, 0.01);
    const std::vector<glm::vec3> whole = image(40, 1, true);
    const ScopedTuning tuning("render/wavefront", "PATHS", 3'001);
    EXPECT_TRUE(same_bits(image(40, 1, true), whole));
}

TEST(AdaptiveSampling, RefusesWhatItCannotDo) {
    RenderConfig config{.width = 16, .height = 16, .adaptive = true};
    Renderer renderer(device(), *builtin_scene("cornell"), config);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "cannot change its size", [&] { renderer.resize(8, 8); }));
    config.approximate.tile_sum = true;
    EXPECT_TRUE(throws_error(ErrorKind::usage, "adaptive sampling and",
                             [&] { Renderer(device(), *builtin_scene("cornell"), config); }));
}

}  // namespace
}  // namespace claray::test
