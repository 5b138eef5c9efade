// Pictures of 8-bit colours, made on the device.
#pragma once

#include "claray/image/picture.hpp"
#include "claray/program.hpp"
#include "claray/shared/picture.h"
#include "host/compute/memory.hpp"

namespace claray {

class ToneMapper {
public:
    ToneMapper(const Device& device, std::uint32_t pixels);

    [[nodiscard]] std::uint32_t pixels() const { return pixels_; }

    /// Converts `image` (3 floats for each of `pixels()` pixels) to red, green, blue and 255 per pixel. Blocks. The
    /// result is overwritten by the next call. It has the bytes that write_image stores.
    [[nodiscard]] std::span<const std::uint8_t> map(const Buffer<float>& image, const PictureConfig& config);
    [[nodiscard]] std::uint64_t bytes() const { return buffer_bytes(table_, picture_); }

private:
    std::uint32_t pixels_;
    Kernel kernel_;
    Buffer<SrgbTable> table_;
    Buffer<std::uint8_t> picture_;
    HostMemory on_host_;
};

/// Returns the table of the exact sRGB curve.
[[nodiscard]] SrgbTable srgb_table();

}  // namespace claray
