#include "host/base/color.hpp"

#include <algorithm>
#include <cmath>

#include "claray/image/picture.hpp"

namespace claray {
namespace {

/// K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. render/tone_map.cl repeats these operations.
float aces(float x) {
    if (!(x > 0.f)) return 0.f;
    x = std::min(x, 1e6f);  // the quotient below would be inf / inf beyond 1e19
    return std::min((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), 1.f);
}

}  // namespace

double decode_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_curve(double linear) {
    if (!(linear > 0.0)) return 0.0;
    if (linear >= 1.0) return 1.0;
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

float tone_mapped(float linear, ToneMap tone_map) { return tone_map == ToneMap::aces ? aces(linear) : linear; }

std::uint8_t srgb_from_linear(float linear) { return std::uint8_t(std::lround(255.0 * srgb_curve(linear))); }

float linear_from_srgb(std::uint8_t value) { return float(decode_srgb(value / 255.0)); }

}  // namespace claray
