// Image decoders of stb_image, from memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

struct ImageShape {
    unsigned width = 0, height = 0, channels = 0;
};

/// What the header of a JPEG, BMP or TGA says; nothing where it is none.
[[nodiscard]] std::optional<ImageShape> image_shape(std::string_view bytes);

/// Fills width * height * channels values from the top left. Returns the reason where the image is broken or cut off;
/// else nothing.
[[nodiscard]] std::string decode_image(std::string_view bytes, ImageShape& shape, std::vector<std::uint8_t>& values);

}  // namespace claray
