// Encoders of images. Into memory, for the callbacks of libraries cannot report that a disk is full.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "claray/io.hpp"

namespace claray {

/// The bytes of a file. `name` tells of the file in errors, which are those of write_image.
[[nodiscard]] std::string encode_image(const std::filesystem::path& name, const Image& image, float exposure,
                                       ToneMap tone_map, const ImageEncoding& encoding);

// At most 16384 pixels a side. Empty where memory runs out.

/// 1 to 4 channels a pixel, of 8 bits, or of 16 in the byte order of this machine.
[[nodiscard]] std::string encode_png(unsigned width, unsigned height, unsigned channels,
                                     std::span<const std::uint8_t> texels, unsigned bits = 8);
/// 3 channels a pixel, or 4 of which the last is ignored. `quality`: 1 to 100. Above 90 colours are as sharp as
/// luminance (4:4:4), else they have half its pixels per side.
[[nodiscard]] std::string encode_jpeg(unsigned width, unsigned height, unsigned channels,
                                      std::span<const std::uint8_t> pixels, unsigned quality);
/// 3 channels a pixel, at most 16383 pixels a side. `quality`: 1 to 100, ignored if lossless.
[[nodiscard]] std::string encode_webp(unsigned width, unsigned height, std::span<const std::uint8_t> pixels,
                                      unsigned quality, bool lossless);
/// 3 channels a pixel.
[[nodiscard]] std::string encode_hdr(unsigned width, unsigned height, const std::vector<float>& rgb);

/// Throws ErrorKind::usage if claray was built without libwebp. `what`: the file that needs it.
void require_webp(const std::string& what);

}  // namespace claray
