// KTX 2 images of Basis Universal (KHR_texture_basisu), by libktx, which is loaded when an image needs it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/image/image_shape.hpp"

namespace claray {

[[nodiscard]] bool is_ktx2(std::string_view bytes);
/// Whether libktx is installed, or $CLARAY_KTX names it.
[[nodiscard]] bool can_read_ktx2();

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_ktx2_header(std::string_view bytes, ImageShape& shape);
/// Fills width * height * 4 values from the top left: the largest level of the first image.
[[nodiscard]] std::string read_ktx2_pixels(std::string_view bytes, const ImageShape& shape,
                                           std::vector<std::uint8_t>& values);

}  // namespace claray
