// Image encoders of stb_image_write. Into memory, for its callbacks cannot report that a disk is full.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace claray {

/// 1 to 4 channels a pixel, HDR 3; at most 16384 pixels a side. Empty where memory runs out.
[[nodiscard]] std::string encode_png(unsigned width, unsigned height, unsigned channels,
                                     const std::vector<std::uint8_t>& texels);
/// Of red, green, blue and an ignored value per pixel. `quality`: 1 to 100.
[[nodiscard]] std::string encode_jpeg(unsigned width, unsigned height, std::span<const std::uint8_t> pixels,
                                      int quality);
[[nodiscard]] std::string encode_hdr(unsigned width, unsigned height, const std::vector<float>& rgb);

}  // namespace claray
