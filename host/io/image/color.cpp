// False colours.
#include "host/io/image/color.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "claray/io.hpp"
#include "claray/shared/types.h"
#include "host/base/color.hpp"

namespace claray {
namespace {

/// Turbo (Anton Mikhailov, "Turbo, An Improved Rainbow Colormap for Visualization", Google AI Blog 2019), by the degree
/// 5 polynomial fit that Ruofei Du published with it. `x` in 0..1; the result is encoded for display.
glm::dvec3 turbo(double x) {
    constexpr glm::dvec3 c[] = {{0.13572138, 0.09140261, 0.10667330},      {4.61539260, 2.19418839, 12.64194608},
                                {-42.66032258, 4.84296658, -60.58204836},  {132.13108234, -14.18503333, 110.36276771},
                                {-152.94239396, 4.27729857, -89.90310912}, {59.28637943, 2.82956604, 27.34824973}};
    return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
}

/// Encoded colour of a hue in 0..1 at full value.
glm::dvec3 hue_color(double hue, double saturation) {
    const auto channel = [&](double shift) {
        const double x = std::abs(std::fmod(6.0 * hue + shift, 6.0) - 3.0) - 1.0;
        return 1.0 - saturation * (1.0 - std::clamp(x, 0.0, 1.0));
    };
    return {channel(0.0), channel(4.0), channel(2.0)};
}

}  // namespace

glm::vec3 linear_from_display(const glm::dvec3& encoded) {
    const glm::dvec3 c = glm::clamp(encoded, 0.0, 1.0);
    return {float(decode_srgb(c.x)), float(decode_srgb(c.y)), float(decode_srgb(c.z))};
}

Image false_color(unsigned width, unsigned height, const std::vector<float>& values) {
    float least = std::numeric_limits<float>::infinity(), largest = -least;
    for (const float value : values) {
        if (!std::isfinite(value)) continue;
        least = std::min(least, value);
        largest = std::max(largest, value);
    }
    const double range = double(largest) - double(least);
    Image image{width, height, std::vector<glm::vec3>(values.size(), glm::vec3(0.f))};
    for (std::size_t i = 0; i < values.size(); ++i)
        if (std::isfinite(values[i]))
            image.pixels[i] = linear_from_display(turbo(range > 0.0 ? (double(values[i]) - least) / range : 0.0));
    return image;
}

Image identifier_color(unsigned width, unsigned height, const std::vector<std::uint32_t>& identifiers) {
    Image image{width, height, std::vector<glm::vec3>(identifiers.size(), glm::vec3(0.f))};
    for (std::size_t i = 0; i < identifiers.size(); ++i) {
        if (identifiers[i] == CLARAY_MISS) continue;
        // Steps of the golden ratio round the circle of hues; every third is paler.
        const std::uint32_t turned = identifiers[i] * 2654435769u;
        const glm::dvec3 color = hue_color(turned * 0x1p-32, identifiers[i] % 3 == 2 ? 0.45 : 0.85);
        image.pixels[i] = linear_from_display(0.95 * color);
    }
    return image;
}

}  // namespace claray
