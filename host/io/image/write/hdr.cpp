// The one translation unit that compiles stb_image_write; static, so that it can't clash with a copy in the host
// program.
#include "host/io/image/write/encode.hpp"

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

std::string encode_hdr(unsigned width, unsigned height, const std::vector<float>& rgb) {
    std::string bytes;
    return stbi_write_hdr_to_func(append, &bytes, int(width), int(height), 3, rgb.data()) ? bytes : std::string();
}

}  // namespace claray
