// The checksums of a PNG, which stb_image doesn't look at.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace claray {

struct PngHeader {
    std::uint32_t width = 0, height = 0;
};

[[nodiscard]] bool is_png(std::string_view bytes);

/// Walks the chunks of a PNG up to its IEND. Returns what is wrong, or nothing; `header` is what IHDR says.
[[nodiscard]] std::string check_png(std::string_view bytes, PngHeader& header);

}  // namespace claray
