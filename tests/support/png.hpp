// PNG files composed by hand, for tests of valid and invalid files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace claray::test {

/// CRC-32 of ISO 3309, bit by bit.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes);

/// Length, type, content and checksum.
[[nodiscard]] std::string png_chunk(const std::string& type, const std::string& content);

/// A zlib stream (RFC 1950) of blocks that are stored, not compressed.
[[nodiscard]] std::string stored_zlib(std::string_view raw);
/// A zlib stream of this many zeros, compressed 158 to 1.
[[nodiscard]] std::string zeros_zlib(std::uint64_t count, std::uint8_t value = 0);

/// Puts the checksums of all chunks right that are there.
void mend_png(std::vector<std::uint8_t>& file);

struct RawPng {
    unsigned width = 1, height = 1, depth = 8;
    unsigned color_type = 0;  ///< 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA
    bool interlaced = false;
    std::vector<std::uint16_t> samples;  ///< row by row from the top left
    std::string palette, transparency;   ///< PLTE and tRNS; without where empty

    [[nodiscard]] unsigned channels() const;
    /// The rows of all passes, none filtered.
    [[nodiscard]] std::string raw() const;
    [[nodiscard]] std::string file() const { return file_with(stored_zlib(raw())); }
    [[nodiscard]] std::string file_with(const std::string& pixels) const;
};

}  // namespace claray::test
