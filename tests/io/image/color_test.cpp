// Colour curves against their definitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "claray/io.hpp"
#include "claray/shared/types.h"

namespace claray {
namespace {

TEST(Color, SrgbRoundTripOfAllValues) {
    for (int value = 0; value < 256; ++value) EXPECT_EQ(srgb_from_linear(linear_from_srgb(std::uint8_t(value))), value);
}

TEST(Color, SrgbMatchesTheStandard) {
    EXPECT_EQ(linear_from_srgb(0), 0.f);
    EXPECT_EQ(linear_from_srgb(255), 1.f);
    EXPECT_NEAR(linear_from_srgb(10), 10.0 / 255.0 / 12.92, 1e-9);  // straight part
    EXPECT_NEAR(linear_from_srgb(128), 0.2158605, 1e-7);
    EXPECT_EQ(srgb_from_linear(0.18f), 118);
    // Rounds to the nearest: the boundary between two values lies halfway on the encoded side.
    for (int value = 0; value < 255; ++value) {
        const double encoded = (value + 0.5) / 255.0;
        const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
        EXPECT_EQ(srgb_from_linear(float(linear * (1.0 - 1e-6))), value);
        EXPECT_EQ(srgb_from_linear(float(linear * (1.0 + 1e-6))), value + 1);
    }
}

TEST(Color, SrgbOfValuesOutOfRange) {
    EXPECT_EQ(srgb_from_linear(-1.f), 0);
    EXPECT_EQ(srgb_from_linear(std::nanf("")), 0);
    EXPECT_EQ(srgb_from_linear(2.f), 255);
    EXPECT_EQ(srgb_from_linear(INFINITY), 255);
}

glm::ivec3 encoded(const glm::vec3& c) { return {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z)}; }

TEST(Color, FalseColorRunsFromBlueThroughGreenToRed) {
    const Image image = false_color(3, 1, {-5.f, 0.f, 5.f});
    // Turbo's published table gives (48,18,59), (164,252,60), (122,4,3). The polynomial is darker at the blue end.
    const glm::ivec3 expected[] = {{48, 18, 59}, {164, 252, 60}, {122, 4, 3}};
    for (std::size_t i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(encoded(image.pixels[i])[k], expected[i][k], i == 0 ? 34 : 24) << i << " " << k;
}

TEST(Color, FalseColorOfValuesThatAreNotFinite) {
    const Image image = false_color(2, 2, {NAN, INFINITY, 7.f, 7.f});
    EXPECT_EQ(image.pixels[0], glm::vec3(0.f));
    EXPECT_EQ(image.pixels[1], glm::vec3(0.f));
    EXPECT_NE(image.pixels[2], glm::vec3(0.f));
    EXPECT_EQ(image.pixels[2], image.pixels[3]);
    const float largest = std::numeric_limits<float>::max();
    const Image extreme = false_color(2, 1, {-largest, largest});
    EXPECT_EQ(extreme.pixels, false_color(2, 1, {0.f, 1.f}).pixels);
    EXPECT_TRUE(false_color(0, 0, {}).pixels.empty());
}

TEST(Color, IdentifiersOfNeighboursLookDifferent) {
    std::vector<std::uint32_t> identifiers(1000);
    for (std::uint32_t i = 0; i < 1000; ++i) identifiers[i] = 4'000'000'000u + i;
    identifiers[999] = CLARAY_MISS;
    const Image image = identifier_color(1000, 1, identifiers);
    EXPECT_EQ(image.pixels[999], glm::vec3(0.f));
    for (std::size_t i = 0; i + 2 < 1000; ++i) {
        const glm::ivec3 difference = glm::abs(encoded(image.pixels[i]) - encoded(image.pixels[i + 1]));
        EXPECT_GT(std::max({difference.x, difference.y, difference.z}), 60) << i;
    }
    EXPECT_EQ(identifier_color(1, 1, {5}).pixels[0], identifier_color(1, 1, {5}).pixels[0]);
}

}  // namespace
}  // namespace claray
