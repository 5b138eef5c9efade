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
    bool radiance = false;  ///< HDR: floats
};

/// What the header of a JPEG, BMP, TGA or HDR says; nothing where it is none.
[[nodiscard]] std::optional<ImageShape> image_shape(std::string_view bytes);

/// One of the vectors is filled, as the shape says: width * height * channels values from the top left.
struct DecodedImage {
    std::vector<std::uint8_t> bytes;
    std::vector<float> floats;
};

/// Returns the reason where the image is broken or cut off; else nothing. A PNG whose transparency is a colour has one
/// channel more than its header says: the shape is corrected.
[[nodiscard]] std::string decode_image(std::string_view bytes, ImageShape& shape, DecodedImage& image);

}  // namespace claray
