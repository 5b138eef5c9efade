// The formats of image files that claray writes.
#pragma once

#include <optional>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

enum class ImageFormat { png, jpeg, webp, hdr, pfm, exr };

struct ImageFormatTraits {
    ImageFormat format;
    const char* name;  ///< and the extension, without its dot
    bool shaped;       ///< by exposure and tone map, into whole numbers; else linear radiance
};
/// All of them; a format may have several names.
inline constexpr ImageFormatTraits image_formats[] = {
    {ImageFormat::png, "png", true},   {ImageFormat::jpeg, "jpg", true}, {ImageFormat::jpeg, "jpeg", true},
    {ImageFormat::webp, "webp", true}, {ImageFormat::hdr, "hdr", false}, {ImageFormat::pfm, "pfm", false},
    {ImageFormat::exr, "exr", false}};

/// How an image file is encoded.
struct ImageEncoding {
    std::optional<ImageFormat> format = {};  ///< empty: by the extension
    unsigned png_bits = 8;                   ///< a channel: 8 or 16
    unsigned quality = 92;                   ///< of a JPEG or a WebP: 1 to 100
    bool lossless = false;                   ///< of a WebP, whatever its quality
};

}  // namespace claray
#pragma GCC visibility pop
