// Base64 (RFC 4648) both ways, for files that tests hold as text.
#pragma once

#include <string>
#include <string_view>

namespace claray::test {

inline constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

inline std::string base64(std::string_view bytes) {
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? base64_digits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

inline std::string from_base64(std::string_view text) {
    std::string bytes;
    unsigned group = 0;
    int bits = 0;
    for (const char c : text) {
        if (c == '=') break;
        group = group << 6 | unsigned(base64_digits.find(c));
        bits += 6;
        if (bits >= 8) bytes += char(group >> (bits -= 8) & 255);
    }
    return bytes;
}

}  // namespace claray::test
