#include "host/io/world/octahedral.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace claray {

glm::dvec2 octahedral_place(const glm::dvec3& direction) {
    const double x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
    const double radius = std::sqrt(std::max(0.0, 1 - z));
    const double larger = std::max(x, y), smaller = std::min(x, y);
    double angle = larger > 0 ? std::atan(smaller / larger) * 2 / std::numbers::pi : 0;  // 0..1/2
    if (x < y) angle = 1 - angle;
    double v = angle * radius, u = radius - v;
    if (direction.z < 0) {
        std::swap(u, v);
        u = 1 - u, v = 1 - v;
    }
    u = std::copysign(u, direction.x), v = std::copysign(v, direction.y);
    return {(u + 1) / 2, (v + 1) / 2};
}

glm::dvec3 linear_texel(const Texture& image, unsigned column, unsigned row) {
    const std::size_t at = (std::size_t(row) * image.width + column) * image.channels;
    glm::dvec3 color;
    for (unsigned k = 0; k < 3; ++k) {
        const std::size_t i = at + (image.channels < 3 ? 0 : k);
        if (image.format == TexelFormat::float32) {
            color[int(k)] = image.floats[i];
            continue;
        }
        const double s = image.bytes[i] / 255.0;
        const bool srgb = image.format == TexelFormat::srgb8;
        color[int(k)] = !srgb ? s : s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    }
    return color;
}

glm::dvec3 octahedral_color(const Texture& image, const glm::dvec3& direction) {
    const glm::dvec2 place = octahedral_place(direction) * glm::dvec2(image.width, image.height) - 0.5;
    const glm::dvec2 low = glm::floor(place), t = place - low;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < 4; ++i) {
        glm::ivec2 at = glm::ivec2(low) + glm::ivec2(i & 1, i >> 1);
        const glm::ivec2 size(image.width, image.height);
        // Beyond an edge the square goes on turned by half a turn about the middle of that edge.
        for (int k = 0; k < 2; ++k) {
            if (at[k] >= 0 && at[k] < size[k]) continue;
            at[k] = at[k] < 0 ? -1 - at[k] : 2 * size[k] - 1 - at[k];
            at[1 - k] = size[1 - k] - 1 - at[1 - k];
        }
        at = glm::clamp(at, glm::ivec2(0), size - 1);
        const double weight = ((i & 1) ? t.x : 1 - t.x) * ((i >> 1) ? t.y : 1 - t.y);
        sum += weight * linear_texel(image, unsigned(at.x), unsigned(at.y));
    }
    return sum;
}

}  // namespace claray
