// The passes of the denoiser against float64: denoise/demodulate.cl, denoise/reject_outliers.cl,
// denoise/estimate_variance.cl, denoise/filter_light.cl and denoise/modulate.cl.
#include "host/denoise/denoiser.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>

#include "tests/denoise/films.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

constexpr std::uint32_t width = 37, height = 23;  // no multiples of a work-group

std::vector<float> denoised(const std::vector<FilmPixel>& film, const std::vector<Guide>& guides,
                            std::uint32_t spp = 4) {
    Denoiser denoiser(device(), width, height);
    return denoiser.denoise(Buffer<FilmPixel>(device(), film), Buffer<Guide>(device(), guides), spp).read();
}

/// Light that differs by side of an edge which no guide shows, on a surface of checked albedo, before a lamp.
struct Wall {
    std::vector<Guide> guides;
    std::vector<glm::dvec3> exact;
    std::vector<double> light;
};
Wall wall() {
    Wall wall;
    for (std::uint32_t i = 0; i < width * height; ++i) {
        const std::uint32_t x = i % width, y = i / width;
        const double albedo = (x / 3 + y / 3) % 2 ? 0.8 : 0.1, light = x < 20 ? 1 : 3;
        const double glow = y < 4 ? 50 : 0;
        wall.guides.push_back(flat_guide(float(albedo), float(glow), 0.2f));
        wall.light.push_back(light);
        wall.exact.emplace_back(albedo * light + glow);
    }
    return wall;
}

std::vector<FilmPixel> sampled(const Wall& wall, unsigned spp, double noise, std::uint64_t seed) {
    Random random(seed);
    std::vector<FilmPixel> film;
    for (std::size_t i = 0; i < wall.guides.size(); ++i) {
        PixelSamples samples;
        for (unsigned s = 0; s < spp; ++s) {
            const double factor = 1 + noise * std::sqrt(3.) * (2 * double(random.uniform()) - 1);
            samples.add(glm::dvec3(wall.guides[i].albedo_r * wall.light[i] * factor + wall.guides[i].glow_r));
        }
        film.push_back(samples.pixel());
    }
    return film;
}

double rms_difference(const std::vector<float>& image, const std::vector<glm::dvec3>& exact) {
    double sum = 0;
    for (std::size_t i = 0; i < exact.size(); ++i)
        for (int c = 0; c < 3; ++c) sum += std::pow(double(image[3 * i + std::size_t(c)]) - exact[i][c], 2);
    return std::sqrt(sum / (3 * double(exact.size())));
}

std::vector<float> means_of(const std::vector<FilmPixel>& film) {
    std::vector<float> means;
    for (const FilmPixel& p : film)
        for (const float sum : {p.all.r, p.all.g, p.all.b}) means.push_back(sum / float(p.count));
    return means;
}

/// Borders of objects are one pixel wide, and the normals of their pixels are those of no neighbour.
TEST(Denoiser, PixelsUnlikeAllNeighboursLoseTheirNoise) {
    Wall scene = wall();
    std::vector<std::size_t> border;
    for (std::size_t i = 0; i < scene.guides.size(); ++i) {
        const std::size_t x = i % width, y = i / width;
        scene.guides[i] = flat_guide(0.5f, 0, 0.2f);
        scene.light[i] = 1, scene.exact[i] = glm::dvec3(0.5);
        if (x % 5 != 2 || y % 5 != 2) continue;  // no pass joins two of these
        scene.guides[i].normal_x = 1, scene.guides[i].normal_z = 0;
        border.push_back(i);
    }
    const std::vector<FilmPixel> film = sampled(scene, 4, 0.8, 5);
    const std::vector<float> before = means_of(film), after = denoised(film, scene.guides);
    double noise = 0, left = 0;
    for (const std::size_t i : border) {
        noise += std::pow(double(before[3 * i]) - 0.5, 2);
        left += std::pow(double(after[3 * i]) - 0.5, 2);
    }
    EXPECT_LT(left, noise / 2) << border.size() << " pixels";
}

TEST(Denoiser, KeepsTexturesLampsAndAnEdgeOfLight) {
    const Wall scene = wall();
    for (const unsigned spp : {4u, 16u}) {
        const std::vector<FilmPixel> film = sampled(scene, spp, 0.8, 11 + spp);
        const double before = rms_difference(means_of(film), scene.exact),
                     after = rms_difference(denoised(film, scene.guides), scene.exact);
        EXPECT_LT(after, before / 2) << spp << " samples: " << before << " -> " << after;
    }
}

TEST(Denoiser, ChangesNothingWithoutNoise) {
    const Wall scene = wall();
    const std::vector<float> image = denoised(sampled(scene, 8, 0, 1), scene.guides);
    EXPECT_LT(rms_difference(image, scene.exact), 1e-5);
}

TEST(Denoiser, LittleNoiseBringsLittleBlur) {
    const Wall scene = wall();
    for (const double noise : {0.1, 0.01, 0.001}) {
        const std::vector<FilmPixel> film = sampled(scene, 8, noise, 5);
        const double before = rms_difference(means_of(film), scene.exact),
                     after = rms_difference(denoised(film, scene.guides), scene.exact);
        EXPECT_LT(after, 1.02 * before) << noise;
    }
}

/// A sample a hundred times as bright as its neighbours is spread; most of its energy is kept.
TEST(Denoiser, FirefliesAreSpread) {
    Wall scene = wall();
    for (std::size_t i = 0; i < scene.guides.size(); ++i)
        scene.guides[i] = flat_guide(0.5f, 0, 0.2f), scene.light[i] = 1, scene.exact[i] = glm::dvec3(0.5);
    std::vector<FilmPixel> film = sampled(scene, 4, 0.3, 3);
    PixelSamples bright;
    for (const double value : {50., 0.5, 0.5, 0.5}) bright.add(glm::dvec3(value));
    film[11 * width + 18] = bright.pixel();
    const std::vector<float> before = means_of(film), after = denoised(film, scene.guides);
    double sum_before = 0, sum_after = 0, largest = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
        sum_before += before[i], sum_after += after[i], largest = std::max(largest, double(after[i]));
    const double without = 3 * 0.5 * double(width * height);
    EXPECT_GT(sum_after - without, 0.5 * (sum_before - without));
    EXPECT_LT(sum_after - without, 1.1 * (sum_before - without));
    EXPECT_LT(largest, 2) << "the firefly was " << before[3 * (11 * width + 18)];
}

/// Random light on surfaces of random albedo, some of which has no surface and some of which is far brighter.
struct LightWithOutliers {
    std::vector<Float4> light;
    std::vector<float> weights;
};
LightWithOutliers light_with_outliers() {
    Random random(31);
    LightWithOutliers made;
    for (std::uint32_t i = 0; i < width * height; ++i) {
        const float bright = random.uniform() < 0.05f ? 50 : 1 + random.uniform(), variance = 1600 * random.uniform();
        const bool lit = random.uniform() < 0.9f;
        made.light.push_back({bright, 0.5f * bright, 2 * bright, lit ? variance : -1});
        made.weights.push_back(lit ? 0.1f + random.uniform() : 0);
    }
    for (const std::uint32_t corner : {0u, width - 1, width * height - 1}) made.light[corner] = {90, 90, 90, 1e4f};
    for (const std::uint32_t corner : {0u, width - 1, width * height - 1}) made.weights[corner] = 0.5f;
    return made;
}

double luminance_of(const Float4& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// The share of a pixel's light beyond twice that of each of the 24 pixels around, or beyond their radiance on a darker
/// surface; with a variance all up to 1.5 standard deviations, and nothing from 3 on, nor if the deviation is less than
/// half of the pixel.
double outlying_share(const LightWithOutliers& of, int x, int y, bool single) {
    const std::size_t here = std::size_t(y * int(width) + x);
    if (of.light[here].w < 0) return 0;
    double most = 0;
    for (int v = std::max(y - 2, 0); v <= std::min(y + 2, int(height) - 1); ++v)
        for (int u = std::max(x - 2, 0); u <= std::min(x + 2, int(width) - 1); ++u) {
            const std::size_t there = std::size_t(v * int(width) + u);
            if (there == here || of.light[there].w < 0) continue;
            const double darker = std::max(1.0, double(of.weights[there]) / double(of.weights[here]));
            most = std::max(most, luminance_of(of.light[there]) * darker);
        }
    const double own = luminance_of(of.light[here]), excess = std::max(own - 2 * most, 0.0);
    const double deviation = std::sqrt(double(of.light[here].w));
    const double explained = deviation < own / 2 ? 0 : 3 * deviation - excess;
    return (single ? excess : std::clamp(explained, 0.0, excess)) / own;
}

TEST(Denoiser, OutliersAreBoundedByTheirNeighbours) {
    Kernel reject = load_kernel(device(), "denoise/reject_outliers.cl", "reject_outliers");
    const LightWithOutliers made = light_with_outliers();
    const std::size_t pixels = width * height;
    const Buffer<Float4> result(device(), pixels), rejected(device(), pixels);
    const bool cpu = device().info().type == DeviceType::cpu;
    for (const bool single : {false, true}) {
        reject.run({cpu ? (width + 15) / 16 * height : pixels, 1}, FilterStep{width, height, 1}, std::uint32_t(single),
                   arg("light", image_on(device(), made.light)), arg("weights", Buffer<float>(device(), made.weights)),
                   arg("result", result), arg("rejected", rejected));
        const std::vector<Float4> left = pixels_of(result), lost = pixels_of(rejected);
        unsigned outliers = 0;
        for (std::size_t i = 0; i < pixels; ++i) {
            const double share = outlying_share(made, int(i % width), int(i / width), single);
            const Float4& before = made.light[i];
            const double factor = 1 - share, tolerance = 1e-4;
            ASSERT_NEAR(left[i].z, factor * double(before.z), tolerance) << i;
            ASSERT_NEAR(left[i].w, factor * factor * double(before.w), tolerance * (1 + double(before.w))) << i;
            ASSERT_NEAR(lost[i].x, share * double(before.x * made.weights[i]), tolerance) << i;
            outliers += share > 0;
        }
        EXPECT_GT(outliers, 8u) << single;
    }
}

/// A firefly on a surface that no neighbour has: the filter finds nothing to mix it with.
TEST(Denoiser, AFireflyUnlikeAllNeighboursIsBounded) {
    constexpr std::size_t alone = 11 * width + 18;
    Wall scene = wall();
    for (std::size_t i = 0; i < scene.guides.size(); ++i) {
        const float turn = 3 * float(i);  // every pixel has a normal of its own
        scene.guides[i] = flat_guide(0.5f, 0, 0.2f), scene.light[i] = 1;
        scene.guides[i].normal_x = std::cos(turn), scene.guides[i].normal_y = std::sin(turn);
        scene.guides[i].normal_z = 0;
    }
    for (const unsigned spp : {4u, 64u}) {
        std::vector<FilmPixel> film = sampled(scene, spp, 0.3, 3);
        PixelSamples bright;
        for (unsigned s = 0; s < spp; ++s) bright.add(glm::dvec3(s == 1 ? 20 * spp : 0.5));
        film[alone] = bright.pixel();
        EXPECT_LT(denoised(film, scene.guides, spp)[3 * alone], 1.5f) << spp << " samples: the firefly was 20";
    }
}

/// One pass of the wavelet in float64, from the formulas of Dammertz et al.; on one surface, since surfaces have tests
/// of their own.
double filtered_here(const std::vector<double>& light, const std::vector<double>& variance, int x, int y, int spacing) {
    const double spline[] = {0.375, 0.25, 0.0625}, tolerance = 6;
    double total = 0, sum = 0;
    const auto at = [&](int px, int py) {
        return std::size_t(std::clamp(py, 0, int(height) - 1) * int(width) + std::clamp(px, 0, int(width) - 1));
    };
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const std::size_t there = at(x + dx * spacing, y + dy * spacing), here = at(x, y);
            const double difference = light[there] - light[here];
            const double far = difference * difference / (tolerance * (variance[here] + variance[there]));
            const double weight = spline[std::abs(dx)] * spline[std::abs(dy)] * std::pow(std::max(1 - far / 8, 0.), 8);
            total += weight, sum += weight * light[there];
        }
    return sum / total;
}

TEST(Denoiser, AWaveletPassIsThatOfFloat64) {
    Random random(17);
    const std::size_t pixels = width * height;
    std::vector<double> light(pixels), variance(pixels);
    std::vector<Float4> packed(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
        light[i] = 1 + double(random.uniform()), variance[i] = 0.05 + 0.1 * double(random.uniform());
        packed[i] = {float(light[i]), float(light[i]), float(light[i]), float(variance[i])};
    }
    Kernel filter = load_kernel(device(), "denoise/filter_light.cl", "filter_light");
    const Buffer<Float4> result(device(), pixels);
    const Buffer<float> kept(device(), pixels);
    std::vector<double> derivatives(pixels, 1);  // of all passes so far
    for (const std::uint32_t spacing : {1u, 4u}) {
        filter.run({pixels, 64}, FilterStep{width, height, spacing}, arg("light", image_on(device(), packed)),
                   arg("surfaces", image_on(device(), std::vector<Float4>(pixels, {0, 0, 1, 0.2f}))),
                   arg("weights", Buffer<float>(device(), std::vector<float>(pixels, 0.7f))),
                   Buffer<Float2>(device(), std::vector<Float2>(pixels)), arg("result", result), arg("kept", kept));
        const std::vector<Float4> values = pixels_of(result);
        const std::vector<float> told = kept.read();
        for (std::size_t i = 0; i < pixels; ++i) {
            const int x = int(i % width), y = int(i / width);
            const double exact = filtered_here(light, variance, x, y, int(spacing));
            ASSERT_NEAR(values[i].x, exact, 1e-5) << i;
            if (x < 8 || y < 8 || x + 8 >= int(width) || y + 8 >= int(height)) continue;  // seen once
            constexpr double step = 1e-6;
            light[i] += step;
            derivatives[i] *= (filtered_here(light, variance, x, y, int(spacing)) - exact) / step;
            light[i] -= step;
            ASSERT_NEAR(told[i], derivatives[i], 0.1) << i;
        }
    }
}

/// The variance of a pixel that no ray met a surface in is -1, and that of its neighbour makes it almost 0.
TEST(Denoiser, PixelsWithoutASurfaceWeighNothing) {
    const std::size_t pixels = width * height;
    std::vector<Float4> packed(pixels, {1, 1, 1, 0.99999f});
    constexpr std::size_t unlit = 11 * width + 20;
    packed[unlit] = {9, 9, 9, -1};
    const Buffer<Float4> result(device(), pixels);
    load_kernel(device(), "denoise/filter_light.cl", "filter_light")
        .run({pixels, 64}, FilterStep{width, height, 1}, arg("light", image_on(device(), packed)),
             arg("surfaces", image_on(device(), std::vector<Float4>(pixels, {0, 0, 1, 0.2f}))),
             arg("weights", Buffer<float>(device(), std::vector<float>(pixels, 0.7f))),
             Buffer<Float2>(device(), std::vector<Float2>(pixels)), arg("result", result),
             arg("kept", Buffer<float>(device(), pixels)));
    const std::vector<Float4> values = pixels_of(result);
    for (std::size_t i = 0; i < pixels; ++i) ASSERT_NEAR(values[i].x, i == unlit ? 9 : 1, 1e-5) << i;
}

/// The image of the last pass, where guides and the share of kept noise are the same everywhere.
std::vector<float> modulated(const std::vector<Float4>& noisy, const std::vector<Float4>& filtered, const Guide& guide,
                             float kept, float doubt, bool single = false) {
    Kernel modulate = load_kernel(device(), "denoise/modulate.cl", "modulate");
    const std::size_t pixels = width * height;
    const Buffer<float> image(device(), 3 * pixels);
    const Buffer<Float4> before = image_on(device(), noisy), after = image_on(device(), filtered);
    const Buffer<Float4> changes(device(), pixels);
    const Buffer<Guide> guides(device(), std::vector<Guide>(pixels, guide));
    load_kernel(device(), "denoise/modulate.cl", "measure_changes")
        .run({pixels, 64}, FilterStep{width, height, 1}, doubt, arg("noisy", before), arg("filtered", after),
             arg("kept", Buffer<float>(device(), std::vector<float>(pixels, kept))), guides, arg("changes", changes));
    modulate.run({pixels, 64}, FilterStep{width, height, 1}, std::uint32_t(single), doubt, arg("noisy", before),
                 arg("filtered", after), arg("changes", changes), guides, arg("image", image));
    return image.read();
}

/// How much of `filtered` the last pass takes, where noise and changes are the same everywhere.
double share_of(const Float4& noisy, const Float4& filtered, const Guide& guide, float kept = 0, float doubt = 1.25f) {
    const std::size_t pixels = width * height;
    const std::vector<float> values =
        modulated(std::vector(pixels, noisy), std::vector(pixels, filtered), guide, kept, doubt);
    for (const std::size_t i : {std::size_t(0), 3 * (pixels - 1)}) EXPECT_EQ(values[i], values[3 * (pixels / 2)]);
    return (double(values[0] - guide.glow_r) / double(guide.albedo_r) - double(noisy.x)) / double(filtered.x - noisy.x);
}

/// Of a pixel that the filter left as it was, the last pass leaves twice its neighbours, unless noise does not explain
/// it or is less than half of it.
TEST(Denoiser, BoundsWhatTheFilterLeft) {
    const std::size_t pixels = width * height;
    for (const std::size_t at : {std::size_t(0), pixels / 2 + 3, pixels - 1})
        for (const float deviation : {0.f, 10.f, 20.f, 30.f, 60.f}) {
            std::vector<Float4> light(pixels, {1, 1, 1, 0});
            light[at] = {50, 50, 50, deviation * deviation};
            const Guide guide = flat_guide(0.5f, 3, 0.2f);
            for (const bool single : {false, true}) {
                const double noise = deviation < 25 ? 0 : std::clamp(3 * double(deviation) - 48, 0.0, 48.0);
                const double bounded = single ? 2 : 50 - noise;
                EXPECT_NEAR(modulated(light, light, guide, 1, 0, single)[3 * at], 0.5 * bounded + 3, 1e-4)
                    << at << ' ' << deviation << ' ' << single;
            }
        }
}

/// The mixture with the least expected error: three quarters of the variance that the filter removed, and `doubt` times
/// all of it, over the squared change.
TEST(Denoiser, MixesByNoiseOverChange) {
    const Guide guide = flat_guide(0.5f, 3, 0.2f);
    for (const float variance : {0.f, 0.25f, 0.5f, 1.f, 4.f})
        for (const float kept : {0.f, 0.6f, 1.f})
            for (const float doubt : {1.25f, 0.f})
                EXPECT_NEAR(share_of({1, 1, 1, variance}, {2, 2, 2, 0}, guide, kept, doubt),
                            std::min(double(variance * (0.75f * (1 - kept) + doubt)), 1.), 1e-5)
                    << variance << ' ' << kept << ' ' << doubt;
}

/// Where a pixel's rays meet surfaces of different normals, many samples are filtered less.
TEST(Denoiser, KeepsDetailsSmallerThanAPixel) {
    Guide guide = flat_guide(0.5f, 3, 0.2f);
    guide.normal_x = 0, guide.normal_y = 0, guide.normal_z = 0.8f;
    for (const float doubt : {1.25f, 0.25f, 0.f})
        EXPECT_NEAR(share_of({1, 1, 1, 4}, {2, 2, 2, 0}, guide, 0, doubt), 1 - 4 * 0.06 * (1 - doubt / 1.25), 1e-5)
            << doubt;
    guide.normal_z = 0;
    EXPECT_NEAR(share_of({1, 1, 1, 4}, {2, 2, 2, 0}, guide, 0, 0), 0, 1e-6);
}

/// Of two colours of the same luminance.
TEST(Denoiser, AChangeOfColorAloneIsAChange) {
    EXPECT_LT(share_of({1, 1, 1, 1e-4f}, {2, 1 - 0.2126f / 0.7152f, 1, 0}, flat_guide(0.5f, 0, 0.2f)), 2e-3);
}

/// Few rays leave an albedo and a glow of known variance; filtered light takes it over, the samples of the film do not.
TEST(Denoiser, NoisyGuidesCountAsNoiseOfTheFilter) {
    constexpr float variance = 4;
    Guide guide = flat_guide(0.5f, 3, 0.2f);
    guide.albedo_variance = 0.05f;
    EXPECT_NEAR(share_of({1, 1, 1, variance}, {2, 2, 2, 0}, guide), variance / (variance + 0.05 * 4 / 0.25), 1e-5);
    guide.complete = 1;  // then they are those of the film's samples
    EXPECT_NEAR(share_of({1, 1, 1, variance}, {2, 2, 2, 0}, guide), 1, 1e-5);
    guide.complete = 0, guide.albedo_variance = 0, guide.glow_variance = 0.4f;
    EXPECT_NEAR(share_of({1, 1, 1, variance}, {2, 2, 2, 0}, guide), variance / (variance + 0.4 / 0.25), 1e-5);
}

/// Gloss of unknown variance is the film's own: it counts neither as noise nor as known.
TEST(Denoiser, GlossOfTheFilmIsNoFurtherNoise) {
    Kernel demodulate = load_kernel(device(), "denoise/demodulate.cl", "demodulate");
    Guide guide = flat_guide(0.5f, 1, 0.2f);
    guide.gloss_r = guide.gloss_g = guide.gloss_b = 1;
    PixelSamples samples;
    for (const double value : {2., 3.}) samples.add(glm::dvec3(value));
    const Buffer<Float4> light(device(), 1), surfaces(device(), 1);
    const Buffer<float> weights(device(), 1);
    const Buffer<Float2> gloss(device(), 1);
    guide.gloss_variance = 0.1f, guide.odd_glow = 1;
    for (const std::uint32_t complete : {0u, 1u}) {
        const float variance = complete ? 0.1f : 0;
        guide.complete = complete;
        demodulate.run({1, 1}, FilterStep{1, 1, 1}, Buffer<FilmPixel>(device(), std::vector{samples.pixel()}),
                       Buffer<Guide>(device(), std::vector{guide}), arg("light", light), arg("surfaces", surfaces),
                       weights, gloss);
        EXPECT_NEAR(light.read()[0].x, (2.5 - 1 + 1) / 0.5, 1e-5);
        EXPECT_NEAR(light.read()[0].w, (0.25 + double(variance)) / 0.25, 1e-5);
        EXPECT_NEAR(gloss.read()[0].x, variance > 0 ? 2 : 0, 1e-5);
    }
}

/// The film has more samples than the guides have rays: some see a surface that no ray has met.
TEST(Denoiser, KeepsLightThatTheGuidesMissed) {
    Wall scene = wall();
    constexpr std::size_t missed = 11 * width + 30;
    const std::vector<FilmPixel> film = sampled(scene, 16, 0.5, 21);
    scene.guides[missed] = flat_guide(0, 2, 0);
    const float mean = film[missed].all.r / 16;
    EXPECT_NEAR(denoised(film, scene.guides, 16)[3 * missed], mean, 1e-5f * mean);
    EXPECT_GT(mean, 0.2f);
}

/// Two surfaces whose depths or normals differ lend each other no light.
TEST(Denoiser, SurfacesAreApart) {
    for (const bool by_normal : {true, false}) {
        Wall scene = wall();
        for (std::size_t i = 0; i < scene.guides.size(); ++i) {
            const bool left = i % width < 20;
            scene.guides[i] = flat_guide(0.5f, 0, by_normal || left ? 0.2f : 0.1f);
            if (by_normal && left) scene.guides[i].normal_x = 1, scene.guides[i].normal_z = 0;
            scene.light[i] = left ? 1 : 1.5, scene.exact[i] = glm::dvec3(0.5 * scene.light[i]);
        }
        const std::vector<float> image = denoised(sampled(scene, 1, 0.9, 2), scene.guides, 1);
        double left = 0, right = 0;
        for (std::size_t y = 0; y < height; ++y)
            left += image[3 * (y * width + 19)] / double(height), right += image[3 * (y * width + 20)] / double(height);
        EXPECT_NEAR(left, 0.5, 0.06) << by_normal;
        EXPECT_NEAR(right, 0.75, 0.09) << by_normal;
    }
}

}  // namespace
}  // namespace claray::test
