#include "host/io/gltf/decode/data_uri.hpp"

#include <algorithm>
#include <cstdint>

#include "host/io/scene_textures.hpp"

namespace claray {
namespace {

std::string lower(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    return result;
}

/// RFC 4648, tables 1 and 2; -1: no digit.
int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+' || c == '-') return 62;
    return c == '/' || c == '_' ? 63 : -1;
}

/// Blanks between digits are left out; '=' ends them.
std::optional<std::string> from_base64(std::string_view text) {
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3);
    std::uint32_t bits = 0;
    unsigned waiting = 0;  // bits that make no byte yet
    for (const char c : text) {
        if (c == '=') break;
        if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
        const int digit = base64_digit(c);
        if (digit < 0) return {};
        bits = bits << 6 | std::uint32_t(digit);
        waiting += 6;
        if (waiting < 8) continue;
        waiting -= 8;
        bytes += char(bits >> waiting & 0xffu);
    }
    if (waiting == 6) return {};  // a single digit is no byte
    return bytes;
}

}  // namespace

bool is_data_uri(std::string_view uri) {
    return lower(uri.substr(0, 5)) == "data:" && uri.find(',') != std::string_view::npos;
}

std::optional<std::string> decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    const std::string_view data = uri.substr(comma + 1);
    const bool escaped = data.find('%') != std::string_view::npos;
    const std::string plain = escaped ? percent_decoded(std::string(data)) : std::string();
    const std::string_view text = escaped ? std::string_view(plain) : data;
    return lower(uri.substr(0, comma)).ends_with(";base64") ? from_base64(text) : std::string(text);
}

}  // namespace claray
