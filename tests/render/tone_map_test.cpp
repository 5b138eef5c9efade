// Pictures of 8 bits made on the device (render/tone_map.cl), against the host's exact curves.
#include "host/render/film/tone_map.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

/// All kinds of values: both sides of every step of the curve, all magnitudes, and what is no radiance.
std::vector<float> values_to_convert() {
    std::vector<float> values;
    const SrgbTable table = srgb_table();
    for (unsigned byte = 0; byte < 256; ++byte)
        for (const float value : {table.step[byte], std::nextafter(table.step[byte], 0.f)}) values.push_back(value);
    Random random(3);
    for (int i = 0; i < 100'000; ++i) {
        values.push_back(random.uniform(0.f, 1.5f));
        values.push_back(std::exp2(random.uniform(-140.f, 120.f)));
    }
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float value : {-0.f, -1.f, -infinity, infinity, std::nanf(""), 1e6f, 3.4e38f}) values.push_back(value);
    while (values.size() % 3 != 0) values.push_back(0);
    return values;
}

TEST(ToneMap, MakesTheBytesOfTheHost) {
    const std::vector<float> values = values_to_convert();
    const Buffer<float> image(device(), values);
    ToneMapper mapper(device(), std::uint32_t(values.size() / 3));
    for (const ToneMap tone_map : {ToneMap::none, ToneMap::aces})
        for (const float exposure : {0.f, 1.3f, -4.f}) {
            const auto picture = mapper.map(image, {exposure, tone_map});
            ASSERT_EQ(picture.size(), values.size() / 3 * 4);
            const float gain = std::exp2(exposure);
            for (std::size_t i = 0; i < values.size(); ++i)
                ASSERT_EQ(int(picture[i / 3 * 4 + i % 3]),
                          int(srgb_from_linear(tone_mapped(gain * values[i], tone_map))))
                    << values[i] << " at exposure " << exposure;
            for (std::size_t i = 3; i < picture.size(); i += 4) ASSERT_EQ(int(picture[i]), 255);
        }
}

/// render/tone_map.cl tries this many steps from the first byte of a cell.
TEST(ToneMap, NoCellHasMoreStepsThanTheKernelTries) {
    const SrgbTable table = srgb_table();
    for (std::uint32_t cell = 0; cell < CLARAY_SRGB_CELLS; ++cell) {
        const float end = std::bit_cast<float>(((cell + 1 + CLARAY_SRGB_LEAST) << CLARAY_SRGB_SHIFT) - 1);
        EXPECT_LE(srgb_from_linear(end), table.first[cell] + CLARAY_SRGB_STEPS);
    }
}

TEST(ToneMap, OfARendererIsThatOfItsImage) {
    Renderer renderer(device(), *builtin_scene("cornell"), {.width = 24, .height = 16, .spp = 4});
    (void)renderer.render();
    const auto picture = renderer.picture({.exposure = 0.5f});
    const std::vector<glm::vec3> image = renderer.image();
    ASSERT_EQ(picture.size(), 4 * image.size());
    for (std::size_t i = 0; i < image.size(); ++i)
        for (int k = 0; k < 3; ++k)
            EXPECT_EQ(picture[4 * i + k], srgb_from_linear(tone_mapped(std::exp2(0.5f) * image[i][k], ToneMap::aces)));
}

/// Bilinear interpolation between the centres of pixels; constant beyond the outer ones.
glm::dvec3 interpolated(const std::vector<glm::vec3>& image, unsigned width, unsigned height, double x, double y) {
    x = std::clamp(x - 0.5, 0.0, double(width - 1)), y = std::clamp(y - 0.5, 0.0, double(height - 1));
    const double u = x - std::floor(x), v = y - std::floor(y);
    const auto at = [&](double i, double j) {
        const auto column = std::min(unsigned(i), width - 1), row = std::min(unsigned(j), height - 1);
        return glm::dvec3(image[std::size_t(row) * width + column]);
    };
    return glm::mix(glm::mix(at(x, y), at(x + 1, y), u), glm::mix(at(x, y + 1), at(x + 1, y + 1), u), v);
}

/// render/resolve_film.cl
TEST(ImageOfAnotherSize, IsInterpolated) {
    constexpr unsigned width = 24, height = 16;
    Renderer renderer(device(), *builtin_scene("cornell"), {.width = width, .height = height, .spp = 4});
    (void)renderer.render();
    const std::vector<glm::vec3> image = renderer.image();
    for (const auto& [w, h] : {std::pair(61u, 37u), std::pair(24u, 17u), std::pair(7u, 5u), std::pair(1u, 1u)}) {
        const std::vector<glm::vec3> other = renderer.image(w, h);
        ASSERT_EQ(other.size(), std::size_t(w) * h);
        for (unsigned i = 0; i < w * h; ++i) {
            const glm::dvec3 expected =
                interpolated(image, width, height, (i % w + 0.5) * width / w, (i / w + 0.5) * height / h);
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(other[i][k], expected[k], 2e-5 * std::max(expected[k], 1.0)) << i;
        }
        const auto picture = renderer.picture({.width = w, .height = h});
        ASSERT_EQ(picture.size(), 4 * other.size());
        for (std::size_t i = 0; i < other.size(); ++i)
            EXPECT_EQ(picture[4 * i], srgb_from_linear(tone_mapped(other[i].x, ToneMap::aces)));
    }
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "invalid image size 20000x16", [&] { (void)renderer.image(20'000, 0); }));
    EXPECT_EQ(renderer.picture().size(), 4u * width * height) << "as before";
}

}  // namespace
}  // namespace claray::test
