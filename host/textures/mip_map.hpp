// Texels in the device's format, with the levels of a mip map.
#pragma once

#include <cstdint>
#include <vector>

#include "claray/texture.hpp"

namespace claray {

/// Linear value of an sRGB byte, by the exact curve (IEC 61966-2-1).
[[nodiscard]] float decode_srgb(std::uint8_t value);
/// The byte whose value is nearest on the curve; `linear` is clamped to 0..1.
[[nodiscard]] std::uint8_t encode_srgb(float linear);

/// A channel of a texel; of srgb8 only the colours are on a curve, not alpha.
[[nodiscard]] float linear_value(const Texture& texture, std::size_t texel, unsigned channel);

/// Levels of a full mip map.
[[nodiscard]] unsigned mip_levels(unsigned width, unsigned height);

/// One vector of words per level, in the texture's own format. Each level is the average of the level above in linear
/// light without rounding; on odd sides texels are weighted by their coverage, so that the mean is kept.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> packed_levels(const Texture& texture, unsigned levels);

}  // namespace claray
