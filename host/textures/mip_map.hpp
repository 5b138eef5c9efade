// Texels as the device reads them, with the levels of a mip map.
#pragma once

#include <cstdint>
#include <vector>

#include "claray/texture.hpp"

namespace claray {

/// Linear value of an sRGB byte, by the exact curve (IEC 61966-2-1).
[[nodiscard]] float decode_srgb(std::uint8_t value);
/// The byte whose value is nearest on the curve; `linear` is clamped to 0..1.
[[nodiscard]] std::uint8_t encode_srgb(float linear);

/// A channel of a texel; only the colours of srgb8 are on a curve, alpha is not.
[[nodiscard]] float linear_value(const Texture& texture, std::size_t texel, unsigned channel);

/// Levels of a full mip map.
[[nodiscard]] unsigned mip_levels(unsigned width, unsigned height);

/// One vector of words a level, in the texture's own format. Every level is the average of the one above it, in linear
/// light and unrounded; where a side is odd, texels are cut by their share, so that the mean stays.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> packed_levels(const Texture& texture, unsigned levels);

}  // namespace claray
