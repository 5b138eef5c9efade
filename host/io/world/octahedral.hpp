// pbrt's images around a scene: a square whose pixels have equal solid angles.
#pragma once

#include "claray/texture.hpp"

namespace claray {

/// The place of a unit direction in the square 0..1, row 0 first (Clarberg 2008, "Fast equal-area mapping of the
/// (hemi)sphere using SIMD"); +z is in the middle.
[[nodiscard]] glm::dvec2 octahedral_place(const glm::dvec3& direction);
/// Bilinear; across the border of the square the image goes on where the octahedron does.
[[nodiscard]] glm::dvec3 octahedral_color(const Texture& image, const glm::dvec3& direction);
/// Linear RGB of the texel in this column and row.
[[nodiscard]] glm::dvec3 linear_texel(const Texture& image, unsigned column, unsigned row);

}  // namespace claray
