// BMP images of Windows and OS/2: 1 to 32 bits a pixel, in runs or not.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/image/image_shape.hpp"

namespace claray {

[[nodiscard]] bool is_bmp(std::string_view bytes);

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_bmp_header(std::string_view bytes, ImageShape& shape);
/// Fills width * height * channels values from the top left. Pixels that runs leave out have the first colour. Runs
/// that go on beyond the image or end early are cut off, as in other readers.
[[nodiscard]] std::string read_bmp_pixels(std::string_view bytes, const ImageShape& shape,
                                          std::vector<std::uint8_t>& values);

}  // namespace claray
