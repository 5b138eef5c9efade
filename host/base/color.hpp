// The sRGB curve.
#pragma once

namespace claray {

/// IEC 61966-2-1, from an encoded value in 0..1.
[[nodiscard]] double decode_srgb(double encoded);
/// Its inverse: a linear value, clamped to 0..1. NaN becomes 0.
[[nodiscard]] double srgb_curve(double linear);

}  // namespace claray
