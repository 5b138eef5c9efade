// From linear radiance to colours of 8 bits.
#pragma once

#include <cstdint>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

enum class ToneMap {
    none,  ///< clamp to 0..1
    aces   ///< filmic curve (Narkowicz 2015 fit to ACES)
};

/// How radiance becomes a picture of 8-bit sRGB colours.
struct PictureConfig {
    float exposure = 0.f;  ///< brightens by this many stops
    ToneMap tone_map = ToneMap::aces;
    unsigned width = 0, height = 0;  ///< of the picture, interpolated bilinearly; 0: those of the image
};

/// Returns the tone-mapped value, which is at most 1 for ToneMap::aces. Negative values and NaN become 0 there.
[[nodiscard]] float tone_mapped(float linear, ToneMap tone_map);

/// Converts a linear value, clamped to 0..1, to an 8-bit value by the exact piecewise sRGB curve (IEC 61966-2-1).
[[nodiscard]] std::uint8_t srgb_from_linear(float linear);
/// The inverse of srgb_from_linear: returns a linear value in 0..1.
[[nodiscard]] float linear_from_srgb(std::uint8_t value);

}  // namespace claray
#pragma GCC visibility pop
