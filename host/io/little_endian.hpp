// Numbers in binary files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace claray {

/// The number of 1 to 8 bytes at a place, of which the first counts least; bytes beyond the end are 0.
[[nodiscard]] inline std::uint64_t little_endian(std::string_view bytes, std::size_t at, unsigned count) {
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;)
        value = value << 8 | (at + i < bytes.size() ? std::uint8_t(bytes[at + i]) : 0u);
    return value;
}

}  // namespace claray
