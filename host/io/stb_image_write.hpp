// Image encoders of stb_image_write. Into memory, for its callbacks cannot report that a disk is full.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace claray {

/// Three channels a pixel, at most 16384 pixels a side. Empty where memory runs out.
[[nodiscard]] std::string encode_png(unsigned width, unsigned height, const std::vector<std::uint8_t>& rgb);
[[nodiscard]] std::string encode_hdr(unsigned width, unsigned height, const std::vector<float>& rgb);

}  // namespace claray
