// Colour curves that image writers share.
#pragma once

#include <glm/glm.hpp>

namespace claray {

/// Filmic tone curve from linear 0.. to linear 0..1: K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. NaN gives 0.
[[nodiscard]] float aces(float linear);

/// By the exact piecewise sRGB curve (IEC 61966-2-1); `encoded` is clamped to 0..1.
[[nodiscard]] glm::vec3 linear_from_display(const glm::dvec3& encoded);

}  // namespace claray
