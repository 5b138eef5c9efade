#include "host/render/mean_texel.hpp"

#include <algorithm>
#include <cmath>

#include "host/render/mip_map.hpp"

namespace claray {
namespace {

/// The texel at a coordinate, 1 being the whole side.
unsigned wrapped(float at, unsigned size, Wrap wrap) {
    double whole = at;
    if (wrap == Wrap::repeat) whole -= std::floor(whole);
    if (wrap == Wrap::mirror) whole = std::abs(whole - 2 * std::round(0.5 * whole));
    return unsigned(std::clamp(whole * size, 0.0, size - 1.0));
}

float value_at(const Texture& t, std::size_t texel, unsigned channel) {
    const std::size_t at = texel * t.channels + channel;
    if (t.format == TexelFormat::float32) return t.floats[at];
    return t.format == TexelFormat::srgb8 ? decode_srgb(t.bytes[at]) : float(t.bytes[at]) / 255.f;
}

}  // namespace

glm::vec3 mean_texel(const Texture& t, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
    const glm::vec2 ab = b - a, ac = c - a;
    const double texels = 0.5 * std::abs(double(ab.x) * ac.y - double(ab.y) * ac.x) * t.width * t.height;
    const auto points = unsigned(std::clamp(std::ceil(2 * texels), 256.0, 1024.0));
    glm::dvec3 sum(0.0);
    // Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": steps by the plastic number's powers.
    for (unsigned i = 0; i < points; ++i) {
        double u = std::fmod(0.3 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.4 + 0.5698402909980532 * i, 1.0);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const glm::vec2 uv = a + float(u) * ab + float(v) * ac;
        const std::size_t texel =
            std::size_t(wrapped(uv.y, t.height, t.wrap_v)) * t.width + wrapped(uv.x, t.width, t.wrap_u);
        for (unsigned k = 0; k < 3; ++k) sum[int(k)] += value_at(t, texel, t.channels >= 3 ? k : 0u);
    }
    return glm::vec3(sum / double(points));
}

}  // namespace claray
