#include "host/io/image/hdr_check.hpp"

#include <cstddef>

namespace claray {
namespace {

unsigned byte_at(std::string_view bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }

std::string_view without_line(std::string_view bytes) {
    const std::size_t end = bytes.find('\n');
    return end == std::string_view::npos ? std::string_view() : bytes.substr(end + 1);
}

/// Behind the header: lines up to an empty one, then the one that tells the size. stb_image takes a 0 for a line's end.
std::string_view pixels_of(std::string_view bytes) {
    while (!bytes.empty() && bytes[0] != '\n' && bytes[0] != '\0') bytes = without_line(bytes);
    return without_line(without_line(bytes));
}

/// Takes one channel of a row away, which is runs: a count above 128 and a value, or a count and as many values.
bool take_channel(std::string_view& bytes, unsigned width) {
    for (unsigned x = 0; x < width;) {
        if (bytes.empty()) return false;
        const unsigned count = byte_at(bytes, 0), pixels = count > 128 ? count - 128 : count;
        const std::size_t length = 1 + (count > 128 ? 1 : count);
        if (bytes.size() < length || pixels > width - x) return false;
        bytes.remove_prefix(length);
        x += pixels;
    }
    return true;
}

}  // namespace

// From a row on that doesn't begin with 2, 2 and the width, pixels are not coded, and end with the file in stb_image,
// too.
bool hdr_runs_fit(std::string_view bytes, unsigned width, unsigned height) {
    if (width < 8 || width >= 32768) return true;
    std::string_view rest = pixels_of(bytes);
    for (unsigned y = 0; y < height; ++y) {
        if (rest.size() < 4 || rest[0] != 2 || rest[1] != 2 || (byte_at(rest, 2) << 8 | byte_at(rest, 3)) != width)
            return true;
        rest.remove_prefix(4);
        for (int channel = 0; channel < 4; ++channel)
            if (!take_channel(rest, width)) return false;
    }
    return true;
}

}  // namespace claray
