// What a view shows instead of the image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "claray/io.hpp"
#include "claray/renderer.hpp"

namespace claray::view {

/// Returns the noise of each pixel in false colours, from the variances of Renderer::noise_map.
[[nodiscard]] Image error_map(const std::vector<float>& variances, int width, int height);
/// Directions as the colours of normal maps: inverts the sRGB curve, so that the stored byte is 127.5 (n + 1).
[[nodiscard]] std::vector<glm::vec3> direction_colors(const std::vector<glm::vec3>& directions);
/// Places as colours: where they are in the box around all of them. 0 0 0 is no place, and black.
[[nodiscard]] std::vector<glm::vec3> place_colors(const std::vector<glm::vec3>& places);
/// Returns the picture of an AOV: `pixels` as in Aovs.
[[nodiscard]] Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<float>& pixels);
[[nodiscard]] Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<glm::vec2>& pixels);
[[nodiscard]] Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<glm::vec3>& pixels);
[[nodiscard]] Image picture_of(AovKind kind, unsigned width, unsigned height, const std::vector<std::uint32_t>& pixels);
/// Returns the picture of the AOV with this name, black if there is none.
[[nodiscard]] Image picture_of(const Aovs& aovs, const std::string& name, unsigned width, unsigned height);
/// Returns red, green, blue, 255 per pixel, by the exact sRGB curve.
[[nodiscard]] std::vector<std::uint8_t> encoded(const Image& image);

}  // namespace claray::view
