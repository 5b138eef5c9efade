#include "host/io/image/formats/primaries.hpp"

#include <algorithm>
#include <cmath>

namespace claray {
namespace {

/// XYZ of a chromaticity at Y = 1.
glm::dvec3 xyz_of(const glm::dvec2& xy) { return {xy.x / xy.y, 1.0, (1 - xy.x - xy.y) / xy.y}; }

glm::dmat3 xyz_from_rgb(const Primaries& p) {
    const glm::dmat3 colors(xyz_of(p.red), xyz_of(p.green), xyz_of(p.blue));
    const glm::dvec3 scale = glm::inverse(colors) * xyz_of(p.white);
    return {scale.x * colors[0], scale.y * colors[1], scale.z * colors[2]};
}

/// Bradford's transform (Lam 1985): scales the responses of cones from one white to the other.
glm::dmat3 adapted(const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dmat3 cones = glm::transpose(
        glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));  // written by rows
    const glm::dvec3 gain = (cones * to) / (cones * from);
    return glm::inverse(cones) * glm::dmat3(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z) * cones;
}

bool is_finite_matrix(const glm::dmat3& m) {
    return std::isfinite(m[0].x + m[0].y + m[0].z + m[1].x + m[1].y + m[1].z + m[2].x + m[2].y + m[2].z);
}

}  // namespace

glm::dmat3 to_rec709(const Primaries& p) {
    constexpr double rounding = 1e-3;
    const auto same = [](const glm::dvec2& a, const glm::dvec2& b) { return glm::length(a - b) < rounding; };
    if (same(p.red, rec709.red) && same(p.green, rec709.green) && same(p.blue, rec709.blue) &&
        same(p.white, rec709.white))
        return glm::dmat3(1.0);
    const glm::dmat3 adaptation = adapted(xyz_of(p.white), xyz_of(rec709.white));
    const glm::dmat3 matrix = glm::inverse(xyz_from_rgb(rec709)) * adaptation * xyz_from_rgb(p);
    return is_finite_matrix(matrix) ? matrix : glm::dmat3(1.0);
}

glm::dmat3 to_rec709_from_xyz() {
    return glm::inverse(xyz_from_rgb(rec709)) * adapted(glm::dvec3(1.0), xyz_of(rec709.white));
}

void convert_colors(std::vector<float>& values, unsigned channels, const glm::dmat3& matrix) {
    if (channels < 3 || matrix == glm::dmat3(1.0)) return;
    for (std::size_t i = 0; i + channels <= values.size(); i += channels) {
        const glm::dvec3 color = matrix * glm::dvec3(values[i], values[i + 1], values[i + 2]);
        for (int c = 0; c < 3; ++c) values[i + std::size_t(c)] = float(std::max(color[c], 0.0));
    }
}

}  // namespace claray
