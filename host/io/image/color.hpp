// Colours for display.
#pragma once

#include <glm/glm.hpp>

namespace claray {

/// By the exact piecewise sRGB curve (IEC 61966-2-1); `encoded` is clamped to 0..1.
[[nodiscard]] glm::vec3 linear_from_display(const glm::dvec3& encoded);

}  // namespace claray
