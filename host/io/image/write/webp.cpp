// WebP through libwebp.
#include "claray/error.hpp"
#include "host/io/image/write/encode.hpp"

#if CLARAY_WITH_WEBP
#include <webp/encode.h>

#include <memory>
#endif

namespace claray {

void require_webp(const std::string& what) {
#if CLARAY_WITH_WEBP
    static_cast<void>(what);
#else
    throw Error(ErrorKind::usage, "cannot write '" + what + "': claray was built without libwebp",
                "install libwebp-dev and build claray again, or write a .png");
#endif
}

#if CLARAY_WITH_WEBP
std::string encode_webp(unsigned width, unsigned height, std::span<const std::uint8_t> pixels, unsigned quality,
                        bool lossless) {
    std::uint8_t* bytes = nullptr;
    const int w = int(width), h = int(height), row = 3 * w;
    const std::size_t size = lossless ? WebPEncodeLosslessRGB(pixels.data(), w, h, row, &bytes)
                                      : WebPEncodeRGB(pixels.data(), w, h, row, float(quality), &bytes);
    const std::unique_ptr<std::uint8_t, void (*)(void*)> owned(bytes, WebPFree);
    return {reinterpret_cast<const char*>(bytes), size};
}
#else
std::string encode_webp(unsigned, unsigned, std::span<const std::uint8_t>, unsigned, bool) { return {}; }
#endif

}  // namespace claray
