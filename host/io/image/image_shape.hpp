// Images of 8 bits a channel, before their pixels are decoded.
#pragma once

#include <cstdint>

namespace claray {

struct ImageShape {
    unsigned width = 0, height = 0, channels = 0;  ///< 1 to 4 channels: grey, grey and alpha, RGB, RGBA
    std::uint64_t least_bytes = 0;                 ///< a shorter file cannot hold its pixels
};

}  // namespace claray
