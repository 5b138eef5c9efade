#pragma once

#include <glm/glm.hpp>

namespace claray {

/// The Y of CIE XYZ, of linear sRGB.
inline double luminance(const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

}  // namespace claray
