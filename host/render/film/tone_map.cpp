#include "host/render/film/tone_map.hpp"

#include <bit>
#include <cmath>

namespace claray {
namespace {

/// The least float that srgb_from_linear converts to `byte` or more, by bisection over the bits of floats.
float least_of(unsigned byte) {
    std::uint32_t low = 0, high = std::bit_cast<std::uint32_t>(1.f);
    while (low < high) {
        const std::uint32_t middle = low + (high - low) / 2;
        if (srgb_from_linear(std::bit_cast<float>(middle)) >= byte)
            high = middle;
        else
            low = middle + 1;
    }
    return std::bit_cast<float>(low);
}

}  // namespace

SrgbTable srgb_table() {
    SrgbTable table{};
    for (unsigned byte = 0; byte < 256; ++byte) table.step[byte] = least_of(byte);
    table.step[256] = INFINITY;
    for (std::uint32_t cell = 0; cell < CLARAY_SRGB_CELLS; ++cell)
        table.first[cell] = srgb_from_linear(std::bit_cast<float>((cell + CLARAY_SRGB_LEAST) << CLARAY_SRGB_SHIFT));
    return table;
}

ToneMapper::ToneMapper(const Device& device, std::uint32_t pixels)
    : pixels_(pixels),
      kernel_(load_kernel(device, "render/tone_map.cl", "tone_map")),
      table_(device, std::vector<SrgbTable>{srgb_table()}),
      picture_(device, 4 * std::size_t(pixels)),
      on_host_(device, picture_.bytes()) {}

std::span<const std::uint8_t> ToneMapper::map(const Buffer<float>& image, const PictureConfig& config) {
    kernel_.run({pixels_, 64}, image, pixels_, std::exp2(config.exposure),
                std::uint32_t(config.tone_map == ToneMap::aces), table_, picture_);
    return on_host_.read(picture_);
}

}  // namespace claray
