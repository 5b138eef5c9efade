// Colours by the primaries of an image, as linear Rec. 709.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace claray {

/// Chromaticities: CIE 1931 x and y.
struct Primaries {
    glm::dvec2 red, green, blue, white;
};
inline constexpr Primaries rec709{{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.3127, 0.329}};

/// The matrix for colours of these primaries. White stays white (the Bradford method, as in ICC profiles). Identity for
/// primaries that are no triangle, and for those that differ from Rec. 709 by roundings.
[[nodiscard]] glm::dmat3 to_rec709(const Primaries& primaries);
/// The same for CIE XYZ, of which 1 1 1 is white.
[[nodiscard]] glm::dmat3 to_rec709_from_xyz();

/// Applies a matrix to the first three of each `channels` values. Colours outside of Rec. 709 end at its border.
void convert_colors(std::vector<float>& values, unsigned channels, const glm::dmat3& matrix);

}  // namespace claray
