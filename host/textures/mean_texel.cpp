#include "host/textures/mean_texel.hpp"

#include <algorithm>
#include <cmath>

#include "host/textures/mip_map.hpp"

namespace claray {
namespace {

/// The texel at a coordinate; 1 is the whole side.
unsigned wrapped(float at, unsigned size, Wrap wrap) {
    double whole = std::isfinite(at) ? at : 0.f;
    if (wrap == Wrap::repeat) whole -= std::floor(whole);
    if (wrap == Wrap::mirror) whole = std::abs(whole - 2 * std::round(0.5 * whole));
    return unsigned(std::clamp(whole * size, 0.0, size - 1.0));
}

std::size_t texel_at(const Texture& t, const glm::vec2& uv) {
    return std::size_t(wrapped(uv.y, t.height, t.wrap_v)) * t.width + wrapped(uv.x, t.width, t.wrap_u);
}

glm::vec3 color_of(const Texture& t, std::size_t texel) {
    if (t.channels < 3) return glm::vec3(linear_value(t, texel, 0));
    return {linear_value(t, texel, 0), linear_value(t, texel, 1), linear_value(t, texel, 2)};
}

}  // namespace

glm::vec4 nearest_texel(const Texture& t, const glm::vec2& uv) {
    const std::size_t texel = texel_at(t, uv);
    return {color_of(t, texel), t.channels % 2 == 0 ? linear_value(t, texel, t.channels - 1) : 1.f};
}

glm::vec3 mean_texel(const Texture& t, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c,
                     unsigned most_points) {
    const glm::vec2 ab = b - a, ac = c - a;
    const double texels = 0.5 * std::abs(double(ab.x) * ac.y - double(ab.y) * ac.x) * t.width * t.height;
    const auto points = unsigned(std::min(std::max(std::ceil(2 * texels), 256.0), double(most_points)));
    glm::dvec3 sum(0.0);
    // Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": steps by the plastic number's powers.
    for (unsigned i = 0; i < points; ++i) {
        double u = std::fmod(0.3 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.4 + 0.5698402909980532 * i, 1.0);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const glm::vec2 uv = a + float(u) * ab + float(v) * ac;
        sum += glm::dvec3(color_of(t, texel_at(t, uv)));
    }
    return glm::vec3(sum / double(points));
}

}  // namespace claray
