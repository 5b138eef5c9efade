// Height fields to normal maps, against slopes in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/io.hpp"
#include "tests/support/errors.hpp"

namespace claray {
namespace {

using std::numbers::pi;

Texture waves(unsigned width, unsigned height) {
    Texture t;
    t.width = width, t.height = height, t.channels = 1, t.format = TexelFormat::float32;
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x)
            t.floats.push_back(float(0.5 + 0.5 * std::sin(2 * pi * (double(x) / width + 2 * double(y) / height))));
    return t;
}

TEST(NormalMap, IsThatOfAWave) {
    const unsigned width = 160, height = 200;
    const Texture map = normal_map_of(waves(width, height), 10.f);
    ASSERT_EQ(map.bytes.size(), 3u * width * height);
    EXPECT_EQ(map.format, TexelFormat::linear8);
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x) {
            const double slope = 5 * 2 * pi * std::cos(2 * pi * (double(x) / width + 2 * double(y) / height));
            const glm::dvec3 normal = glm::normalize(glm::dvec3(-slope / width, 2 * slope / height, 1));
            for (unsigned k = 0; k < 3; ++k)  // half a step of the bytes, and the differences' error
                ASSERT_NEAR(map.bytes[3 * (y * width + x) + k] / 255.0, 0.5 + 0.5 * normal[int(k)], 0.5 / 255 + 3e-4)
                    << x << ' ' << y << ' ' << k;
        }
}

TEST(NormalMap, ContinuesAsItsImage) {
    Texture ramp;
    ramp.width = 4, ramp.height = 2, ramp.channels = 1, ramp.format = TexelFormat::linear8;
    ramp.bytes = {0, 85, 170, 255, 0, 85, 170, 255};
    const auto red = [&](Wrap wrap, float strength) {
        ramp.wrap_u = ramp.wrap_v = wrap;
        const Texture map = normal_map_of(ramp, strength);
        return std::vector<int>{map.bytes[0], map.bytes[3], map.bytes[6], map.bytes[9]};
    };
    const auto byte = [](double slope) { return int(std::lround(255 * (0.5 - 0.5 * slope / std::hypot(slope, 1)))); };
    EXPECT_EQ(red(Wrap::clamp, 3.f), (std::vector<int>{byte(0.5), byte(1), byte(1), byte(0.5)}));
    EXPECT_EQ(red(Wrap::repeat, 3.f), (std::vector<int>{byte(-1), byte(1), byte(1), byte(-1)}));
    EXPECT_EQ(red(Wrap::clamp, -3.f), (std::vector<int>{byte(-0.5), byte(-1), byte(-1), byte(-0.5)}));
    EXPECT_EQ(red(Wrap::clamp, 0.f), (std::vector<int>{128, 128, 128, 128}));
}

TEST(NormalMap, RefusesAnImageWithoutTexels) {
    EXPECT_TRUE(test::throws_error(ErrorKind::user, "size is not that", [] { (void)normal_map_of(Texture()); }));
}

}  // namespace
}  // namespace claray
