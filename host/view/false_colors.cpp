#include "host/view/false_colors.hpp"

#include <algorithm>
#include <cmath>

namespace claray::view {
namespace {

constexpr int noise_radius = 2;  // of the square of pixels over which the error map takes the mean

}  // namespace

std::vector<std::uint8_t> encoded(const Image& image) {
    std::vector<std::uint8_t> bytes;
    for (const glm::vec3& c : image.pixels)
        bytes.insert(bytes.end(), {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z), 255});
    return bytes;
}

/// The root of the mean over the pixels nearby: the variance that two halves of a pixel's samples tell is as noisy as
/// its square.
Image error_map(const std::vector<float>& variances, int width, int height) {
    std::vector<float> errors;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            int count = 0;
            for (int v = std::max(y - noise_radius, 0); v <= std::min(y + noise_radius, height - 1); ++v)
                for (int u = std::max(x - noise_radius, 0); u <= std::min(x + noise_radius, width - 1); ++u, ++count)
                    sum += double(variances[std::size_t(v) * std::size_t(width) + std::size_t(u)]);
            errors.push_back(float(std::sqrt(sum / count)));
        }
    return false_color(unsigned(width), unsigned(height), errors);
}

std::vector<glm::vec3> direction_colors(const std::vector<glm::vec3>& directions) {
    const auto channel = [](float n) {
        return linear_from_srgb(std::uint8_t(std::lround(127.5f * (glm::clamp(n, -1.f, 1.f) + 1.f))));
    };
    std::vector<glm::vec3> colors;
    colors.reserve(directions.size());
    for (const glm::vec3& d : directions) colors.emplace_back(channel(d.x), channel(d.y), channel(d.z));
    return colors;
}

std::vector<glm::vec3> place_colors(const std::vector<glm::vec3>& places) {
    Bounds bounds;
    for (const glm::vec3& place : places)
        if (place != glm::vec3(0.f)) bounds.grow(place);
    const glm::vec3 extent = glm::max(bounds.extent(), 1e-30f);
    std::vector<glm::vec3> colors = places;
    for (glm::vec3& color : colors)
        if (color != glm::vec3(0.f)) color = (color - bounds.lo) / extent;
    return colors;
}

Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<float>& pixels) {
    if (kind == AovKind::distance) return false_color(width, height, pixels);
    return {width, height, {pixels.begin(), pixels.end()}};
}

/// Coordinates repeat; movements are grey where there is none, and brighter to the right and down.
Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<glm::vec2>& pixels) {
    float longest = 1e-30f;
    for (const glm::vec2& way : pixels) longest = std::max({longest, std::abs(way.x), std::abs(way.y)});
    std::vector<glm::vec3> colors;
    colors.reserve(pixels.size());
    for (const glm::vec2& p : pixels)
        colors.emplace_back(kind == AovKind::coordinates ? glm::vec3(glm::fract(p), 0.f)
                                                         : glm::vec3(0.5f + 0.5f / longest * p, 0.5f));
    return {width, height, colors};
}

Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<glm::vec3>& pixels) {
    if (kind == AovKind::place) return {width, height, place_colors(pixels)};
    return {width, height, kind == AovKind::direction ? direction_colors(pixels) : pixels};
}

Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<std::uint32_t>& pixels) {
    if (kind == AovKind::identifier) return identifier_color(width, height, pixels);
    return false_color(width, height, {pixels.begin(), pixels.end()});
}

Image picture_of(const Aovs& aovs, const std::string& name, unsigned width, unsigned height) {
    Image picture{width, height, std::vector<glm::vec3>(std::size_t(width) * height)};
    for_each_aov(aovs, [&](const AovRow& row, const auto& pixels) {
        if (name == row.name) picture = picture_of(row.kind, width, height, pixels);
    });
    return picture;
}

}  // namespace claray::view
