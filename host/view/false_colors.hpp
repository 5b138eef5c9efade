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
/// Returns the picture of "depth", "normal", "albedo", "primitive" or "heat".
[[nodiscard]] Image image_of(const Aovs& aovs, const std::string& shows, unsigned width, unsigned height);
/// Returns red, green, blue, 255 per pixel, by the exact sRGB curve.
[[nodiscard]] std::vector<std::uint8_t> encoded(const Image& image);

}  // namespace claray::view
