// What BMP and TGA have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace claray {

/// RGBA whose alpha is 0 everywhere has padding instead of alpha: it becomes opaque.
inline void fill_empty_alpha(std::vector<std::uint8_t>& values) {
    for (std::size_t i = 3; i < values.size(); i += 4)
        if (values[i] != 0) return;
    for (std::size_t i = 3; i < values.size(); i += 4) values[i] = 255;
}

}  // namespace claray
