// TGA images: grey, colours and colour maps, in runs or not.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/image/image_shape.hpp"

namespace claray {

/// Whether the header can be one of a TGA, which has no signature.
[[nodiscard]] bool is_tga(std::string_view bytes);

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_tga_header(std::string_view bytes, ImageShape& shape);
/// Fills width * height * channels values from the top left.
[[nodiscard]] std::string read_tga_pixels(std::string_view bytes, const ImageShape& shape,
                                          std::vector<std::uint8_t>& values);

}  // namespace claray
