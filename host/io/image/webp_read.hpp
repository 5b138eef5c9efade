// WebP images, by libwebp where claray was built with it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

struct WebpImage {
    unsigned width = 0, height = 0, channels = 0;  ///< 3, or 4 with alpha
    std::vector<std::uint8_t> bytes;               ///< row by row from the top left
};

[[nodiscard]] bool is_webp(std::string_view bytes);

/// Reads the sizes. Returns what is wrong, or nothing.
[[nodiscard]] std::string read_webp_header(std::string_view bytes, WebpImage& image);
/// Reads the pixels, after the header. Returns what is wrong, or nothing.
[[nodiscard]] std::string read_webp_pixels(std::string_view bytes, WebpImage& image);

}  // namespace claray
