// WebP images, by libwebp where claray was built with it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/image/image_shape.hpp"

namespace claray {

[[nodiscard]] bool is_webp(std::string_view bytes);

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_webp_header(std::string_view bytes, ImageShape& shape);
/// Fills width * height * channels values from the top left.
[[nodiscard]] std::string read_webp_pixels(std::string_view bytes, const ImageShape& shape,
                                           std::vector<std::uint8_t>& values);

}  // namespace claray
