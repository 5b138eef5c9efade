// What BMP and TGA have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace claray {

/// The number of 1 to 4 bytes at a place, of which the first counts least; bytes beyond the end are 0.
[[nodiscard]] inline std::uint32_t little_endian(std::string_view bytes, std::size_t at, unsigned count) {
    std::uint32_t value = 0;
    for (std::size_t i = count; i-- > 0;)
        value = value << 8 | (at + i < bytes.size() ? std::uint8_t(bytes[at + i]) : 0u);
    return value;
}

/// RGBA whose alpha is 0 everywhere has padding instead of alpha: it becomes opaque.
inline void fill_empty_alpha(std::vector<std::uint8_t>& values) {
    for (std::size_t i = 3; i < values.size(); i += 4)
        if (values[i] != 0) return;
    for (std::size_t i = 3; i < values.size(); i += 4) values[i] = 255;
}

}  // namespace claray
