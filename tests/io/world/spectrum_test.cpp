// Spectra to colours, and reflectances, against closed forms and published values.
#include "host/io/world/spectrum.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "host/io/world/rough.hpp"

namespace claray {
namespace {

TEST(Spectrum, OfOneIsWhiteInDaylightAndHasALuminanceOfOneAsLight) {
    const std::array<SpectrumSample, 2> one = {{{300, 1}, {900, 1}}};
    const glm::vec3 white = rgb_of_reflectance(one);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(white[k], 1.f, 0.003f) << k;
    const glm::vec3 light = rgb_of_light(one);
    EXPECT_NEAR(luminance_of(light), 1.f, 1e-3f);
    EXPECT_GT(light.x, light.z);  // equal energy is redder than D65
}

TEST(Spectrum, OfANarrowBandHasItsColor) {
    const std::array<SpectrumSample, 2> green = {{{520, 1}, {540, 1}}}, red = {{{640, 1}, {660, 1}}};
    EXPECT_GT(rgb_of_light(green).y, 0.f);
    EXPECT_LT(rgb_of_light(green).x, 0.f);  // outside Rec. 709
    EXPECT_GT(rgb_of_light(red).x, 3 * std::abs(rgb_of_light(red).y));
}

/// Chromaticities of Planck's locus (CIE 15): at 6500 K x = 0.3135, y = 0.3237; at 2856 K x = 0.4476, y = 0.4074.
TEST(Spectrum, OfBlackBodies) {
    const auto chromaticity = [](const glm::dvec3& c) {
        const glm::dvec3 xyz(0.4124564 * c.x + 0.3575761 * c.y + 0.1804375 * c.z,
                             0.2126729 * c.x + 0.7151522 * c.y + 0.0721750 * c.z,
                             0.0193339 * c.x + 0.1191920 * c.y + 0.9503041 * c.z);
        return glm::dvec2(xyz) / (xyz.x + xyz.y + xyz.z);
    };
    const glm::dvec2 day = chromaticity(rgb_of_blackbody(6500)), lamp = chromaticity(rgb_of_blackbody(2856));
    EXPECT_NEAR(day.x, 0.3135, 1e-3);
    EXPECT_NEAR(day.y, 0.3237, 1e-3);
    EXPECT_NEAR(lamp.x, 0.4476, 1e-3);
    EXPECT_NEAR(lamp.y, 0.4074, 1e-3);
    EXPECT_NEAR(luminance_of(rgb_of_blackbody(2856)), 1.f, 1e-3f);
}

TEST(Conductors, AgreeWithTheDielectricWithoutExtinctionAndWithNormalIncidence) {
    for (const double cosine : {1.0, 0.7, 0.3, 0.05}) {
        const double inside = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
        const double s = (cosine - 1.5 * inside) / (cosine + 1.5 * inside),
                     p = (1.5 * cosine - inside) / (1.5 * cosine + inside);
        EXPECT_NEAR(conductor_reflectance(1.5, 0, cosine), (s * s + p * p) / 2, 1e-12);
    }
    EXPECT_NEAR(conductor_reflectance(0.2, 3.9, 1), (0.64 + 15.21) / (1.44 + 15.21), 1e-12);
    EXPECT_NEAR(conductor_reflectance(0, 1, 0.4), 1, 1e-12);  // Mitsuba's "none"
}

TEST(Conductors, HaveNamesInBothFormats) {
    ASSERT_TRUE(conductor_named("metal-Au-eta") && conductor_named("Au"));
    EXPECT_EQ(conductor_named("metal-Au-k")->k, conductor_named("Au")->k);
    EXPECT_TRUE(conductor_named("Ni_palik"));
    EXPECT_FALSE(conductor_named("unobtainium"));
    const glm::vec3 gold = schlick_color(*conductor_named("Au"));
    EXPECT_GT(gold.x, gold.y);
    EXPECT_GT(gold.y, gold.z);
    EXPECT_EQ(schlick_color(*conductor_named("none")), glm::vec3(1.f));
    EXPECT_FLOAT_EQ(*ior_named("bk7"), 1.5046f);
    EXPECT_FALSE(ior_named("unobtainium"));
}

/// Diffuse light within n = 1.5: 0.596 (d'Eon and Irving 2011, table of internal reflectances).
TEST(Plastic, ReturnsTheShareOfLightThatItsBorderSendsBack) {
    const double inner = inner_reflectance(1.5);
    EXPECT_NEAR(inner, 0.596, 1e-3);
    const RoughBase smooth(1.5, {}, true);
    EXPECT_NEAR(smooth.albedo(1.f), 1.f, 1e-6f);
    double sum = 0, now = 0.5 * (1 - inner);
    for (int bounce = 0; bounce < 200; ++bounce, now *= 0.5 * inner) sum += now;  // leaves after each reflection
    EXPECT_NEAR(smooth.albedo(0.5f), sum, 1e-6);
    EXPECT_NEAR(RoughBase(1.5, {}, false).albedo(0.5f), 0.5f, 1e-6f);
}

/// Where facets are nearly smooth, their shares are those of a smooth border, and they lose little; rough ones lose
/// more.
TEST(Rough, BordersLoseLightByTheirRoughness) {
    const RoughBorder nearly = rough_border(1.5, {0.002}), rough = rough_border(1.5, {0.5});
    EXPECT_NEAR(nearly.reflected + nearly.passed, 1, 2e-3);
    EXPECT_NEAR(nearly.reflected, 1 - (1 - inner_reflectance(1.5)) * 2.25, 2e-3);  // reciprocity
    EXPECT_NEAR(rough_border(1 / 1.5, {0.002}).reflected, inner_reflectance(1.5), 5e-3);
    EXPECT_LT(rough.reflected + rough.passed, 0.99);
    EXPECT_NEAR(kept_by_facets({0.002}), 1, 1e-3);
    EXPECT_LT(kept_by_facets({1}), 0.65);
    EXPECT_GT(kept_by_facets({0.1}), kept_by_facets({0.3}));
}

/// What facets reflect at once: D G / (4 cosine cosine) over all pairs of directions (Walter et al. 2007, equation 20).
double kept_by_sum(double alpha, bool beckmann) {
    constexpr double pi = std::numbers::pi;
    const auto tangent2 = [](double c) { return (1 - c * c) / (c * c); };
    const auto masking = [&](double c) {
        const double t = alpha * alpha * tangent2(c), a = 1 / std::sqrt(t);
        return beckmann ? 2 / (1 + std::erf(a) + std::exp(-a * a) / (a * std::sqrt(pi))) : 2 / (1 + std::sqrt(1 + t));
    };
    const auto density = [&](double c) {
        const double t = tangent2(c) / (alpha * alpha), scale = pi * alpha * alpha * c * c * c * c;
        return beckmann ? std::exp(-t) / scale : 1 / (scale * (1 + t) * (1 + t));
    };
    constexpr int cosines = 60, turns = 120;
    double sum = 0;
    for (int i = 0; i < cosines; ++i)
        for (int o = 0; o < cosines; ++o)
            for (int k = 0; k < turns; ++k) {
                const double in = (i + 0.5) / cosines, out = (o + 0.5) / cosines, turn = (k + 0.5) * 2 * pi / turns;
                const double x = std::sqrt(1 - in * in) + std::sqrt(1 - out * out) * std::cos(turn),
                             y = std::sqrt(1 - out * out) * std::sin(turn), z = in + out;
                const double facet = z / std::sqrt(x * x + y * y + z * z);
                sum += density(facet) * masking(in) * masking(out) / (4 * in * out) * 2 * in * out * (2 * pi / turns) /
                       (cosines * cosines);
            }
    return sum;
}

TEST(Rough, FacetsKeepWhatTheirDistributionDoes) {
    for (const double alpha : {0.3, 0.6}) {
        EXPECT_NEAR(kept_by_facets({alpha}), kept_by_sum(alpha, false), 2e-3) << alpha;
        EXPECT_NEAR(kept_by_facets({alpha, true}), kept_by_sum(alpha, true), 2e-3) << alpha;
    }
}

/// Burley's lobe, summed over pairs of directions of diffuse light.
TEST(Rough, MeanOfBurleysDiffuseLobe) {
    constexpr int steps = 48;
    for (const double roughness : {0.0, 0.5, 1.0}) {
        double sum = 0;
        for (int i = 0; i < steps * steps * steps; ++i) {
            const double in = (i % steps + 0.5) / steps, out = (i / steps % steps + 0.5) / steps,
                         turn = std::numbers::pi * (i / (steps * steps) + 0.5) / steps;
            const double between = in * out + std::sqrt((1 - in * in) * (1 - out * out)) * std::cos(turn);
            const double half2 = (1 + between) / 2, a = std::pow(1 - in, 5), b = std::pow(1 - out, 5),
                         retro = 2 * roughness * half2;
            sum += 4 * in * out * ((1 - a / 2) * (1 - b / 2) + retro * (a + b + a * b * (retro - 1)));
        }
        EXPECT_NEAR(burley_diffuse(roughness), sum / (steps * steps * steps), 2e-4) << roughness;
    }
}

/// Facets that lose nothing: each order of scattering keeps E and reflects F.
TEST(Rough, DarkenedMetalReflectsAsMuchAtAllOrdersAsTheOtherAtTheFirst) {
    const double kept = 0.8, f = darkened_metal(0.9f, kept);
    double sum = 0, now = f;
    for (int order = 0; order < 100; ++order, now *= f * (1 - kept)) sum += now * kept;
    EXPECT_NEAR(sum, 0.9 * kept, 1e-6);
    EXPECT_FLOAT_EQ(darkened_metal(0.7f, 1), 0.7f);
}

}  // namespace
}  // namespace claray
