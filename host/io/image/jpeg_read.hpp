// JPEG through libjpeg, from memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/image/image_shape.hpp"

namespace claray {

[[nodiscard]] bool is_jpeg(std::string_view bytes);

/// Both return what is wrong with the file, or nothing. Pixels that are cut off or damaged are wrong; bytes between
/// segments that mean nothing are not.
[[nodiscard]] std::string read_jpeg_header(std::string_view bytes, ImageShape& shape);
/// Fills width * height * channels values from the top left. Inks (CMYK) become red, green and blue.
[[nodiscard]] std::string read_jpeg_pixels(std::string_view bytes, const ImageShape& shape,
                                           std::vector<std::uint8_t>& values);

}  // namespace claray
