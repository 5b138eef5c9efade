#include "host/io/image/webp_read.hpp"

#if CLARAY_WITH_WEBP
#include <webp/decode.h>

#include <memory>
#endif

namespace claray {

bool is_webp(std::string_view bytes) {
    return bytes.size() >= 12 && bytes.substr(0, 4) == "RIFF" && bytes.substr(8, 4) == "WEBP";
}

#if CLARAY_WITH_WEBP
namespace {

const std::uint8_t* words(std::string_view bytes) { return reinterpret_cast<const std::uint8_t*>(bytes.data()); }

}  // namespace

std::string read_webp_header(std::string_view bytes, ImageShape& shape) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(words(bytes), bytes.size(), &features) != VP8_STATUS_OK) return "its WebP header is damaged";
    if (features.has_animation) return "it is an animation";
    shape.width = unsigned(features.width), shape.height = unsigned(features.height);
    shape.channels = features.has_alpha ? 4 : 3;
    return {};
}

/// The library's memory is copied only once all is decoded, so that broken data touches little of it.
std::string read_webp_pixels(std::string_view bytes, const ImageShape& shape, std::vector<std::uint8_t>& values) {
    int width = 0, height = 0;
    const auto decode = shape.channels == 4 ? WebPDecodeRGBA : WebPDecodeRGB;
    const std::unique_ptr<std::uint8_t, void (*)(void*)> pixels(decode(words(bytes), bytes.size(), &width, &height),
                                                                WebPFree);
    if (!pixels || unsigned(width) != shape.width || unsigned(height) != shape.height)
        return "it is cut off or damaged";
    values.assign(pixels.get(), pixels.get() + std::size_t(shape.width) * shape.height * shape.channels);
    return {};
}

#else
std::string read_webp_header(std::string_view, ImageShape&) { return "claray was built without libwebp"; }
std::string read_webp_pixels(std::string_view, const ImageShape&, std::vector<std::uint8_t>&) {
    return "claray was built without libwebp";
}
#endif

}  // namespace claray
