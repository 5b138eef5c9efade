#include "host/io/png_check.hpp"

#include <array>

namespace claray {
namespace {

constexpr std::string_view signature("\x89PNG\r\n\x1a\n", 8);

std::uint32_t big_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::uint8_t(bytes[i]);
    return value;
}

/// CRC-32 of ISO 3309, as the PNG specification asks for (annex D): the remainders of all bytes.
constexpr std::array<std::uint32_t, 256> make_remainders() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        table[i] = i;
        for (int bit = 0; bit < 8; ++bit) table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0xedb88320u : 0u);
    }
    return table;
}

std::uint32_t crc32(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> remainders = make_remainders();
    std::uint32_t crc = ~0u;
    for (const char c : bytes) crc = crc >> 8 ^ remainders[(crc ^ std::uint8_t(c)) & 0xff];
    return ~crc;
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.substr(0, signature.size()) == signature; }

std::string check_png(std::string_view bytes, PngHeader& header) {
    std::string_view rest = bytes.substr(signature.size());
    for (bool first = true;; first = false) {
        constexpr std::size_t frame = 12;  // length, type, checksum
        if (rest.size() < frame) return "it is cut off";
        const std::size_t length = big_endian(rest);
        if (length > rest.size() - frame) return "it is cut off";
        const std::string_view type = rest.substr(4, 4);
        if (crc32(rest.substr(4, 4 + length)) != big_endian(rest.substr(8 + length))) return "a checksum is wrong";
        if (first && (type != "IHDR" || length != 13)) return "it does not begin with a header";
        if (first) header = {big_endian(rest.substr(8)), big_endian(rest.substr(12))};
        if (type == "IEND") return {};
        rest.remove_prefix(frame + length);
    }
}

}  // namespace claray
