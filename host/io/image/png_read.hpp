// PNG through libpng, from memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "claray/texture.hpp"

namespace claray {

struct PngHeader {
    std::uint32_t width = 0, height = 0;
    unsigned channels = 0;  ///< of the texels: palettes become RGB, transparency an alpha channel
    bool sixteen_bits = false;
    std::uint64_t raw_bytes = 0;  ///< of the pixels as they are stored, before they are compressed
};

[[nodiscard]] bool is_png(std::string_view bytes);

/// Reads what is before the pixels. Returns what is wrong, or nothing.
[[nodiscard]] std::string read_png_header(std::string_view bytes, PngHeader& header);

/// Reads all of a PNG whose header was read. Fills `bytes`, or `floats` in 0..1 where a channel has 16 bits; sRGB is
/// left as it is. Memory is that of the texels and some rows, whatever the file says. Returns what is wrong, or
/// nothing: bits that are cut off, a wrong checksum of any chunk.
[[nodiscard]] std::string read_png(std::string_view bytes, const PngHeader& header, Texture& texture);

}  // namespace claray
