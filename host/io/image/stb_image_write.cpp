// The one translation unit that compiles stb_image_write; static, so that it can't clash with a copy in the host
// program.
#include "host/io/image/stb_image_write.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace claray {
namespace {

void append(void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), std::size_t(size));
}

}  // namespace

std::string encode_png(unsigned width, unsigned height, unsigned channels, const std::vector<std::uint8_t>& texels) {
    std::string bytes;
    const int w = int(width), h = int(height), n = int(channels);
    return stbi_write_png_to_func(append, &bytes, w, h, n, texels.data(), n * w) ? bytes : std::string();
}

std::string encode_jpeg(unsigned width, unsigned height, std::span<const std::uint8_t> pixels, int quality) {
    std::string bytes;
    return stbi_write_jpg_to_func(append, &bytes, int(width), int(height), 4, pixels.data(), quality) ? bytes
                                                                                                      : std::string();
}

std::string encode_hdr(unsigned width, unsigned height, const std::vector<float>& rgb) {
    std::string bytes;
    return stbi_write_hdr_to_func(append, &bytes, int(width), int(height), 3, rgb.data()) ? bytes : std::string();
}

}  // namespace claray
