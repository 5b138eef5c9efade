// The format is in "Truevision TGA File Format Specification, Version 2.0" (1991).
#include "host/io/image/formats/tga.hpp"

#include <algorithm>
#include <string>

#include "host/io/image/formats/empty_alpha.hpp"
#include "host/io/little_endian.hpp"

namespace claray {
namespace {

using Values = std::vector<std::uint8_t>;

constexpr std::size_t tga_header_bytes = 18;
enum Kind : unsigned { mapped = 1, colors = 2, grey = 3 };

struct Tga {
    unsigned kind = 0;
    bool has_runs = false, has_map = false;
    std::size_t map_first = 0, map_length = 0, map_bits = 0;
    std::size_t width = 0, height = 0, bits = 0, descriptor = 0;
    std::size_t map = 0;  ///< the byte at which it begins

    [[nodiscard]] std::size_t entry_bytes() const { return (map_bits + 7) / 8; }
    [[nodiscard]] std::size_t pixel_bytes() const { return (bits + 7) / 8; }
    [[nodiscard]] std::size_t pixels() const { return map + (has_map ? map_length * entry_bytes() : 0); }
    [[nodiscard]] unsigned channels() const {
        const std::size_t of_color = kind == mapped ? map_bits : bits;
        return of_color == 8 ? 1 : kind == grey ? 2 : of_color == 32 ? 4 : 3;
    }
};

Tga header_of(std::string_view bytes) {
    const auto field = [&](std::size_t at, unsigned count = 1) { return little_endian(bytes, at, count); };
    Tga tga;
    tga.kind = field(2) & 7, tga.has_runs = (field(2) & 8) != 0, tga.has_map = field(1) == 1;
    tga.map_first = field(3, 2), tga.map_length = field(5, 2), tga.map_bits = field(7);
    tga.width = field(12, 2), tga.height = field(14, 2), tga.bits = field(16), tga.descriptor = field(17);
    tga.map = tga_header_bytes + field(0);
    return tga;
}

bool is_color_depth(std::size_t bits) { return bits == 15 || bits == 16 || bits == 24 || bits == 32; }

/// Blue, green, red and alpha, or 5 bits of each in two bytes, whose highest is ignored as by other readers.
void put_color(std::string_view bytes, std::size_t at, unsigned channels, std::size_t size, std::uint8_t* to) {
    if (channels <= 2) {
        for (std::size_t c = 0; c < channels; ++c) to[c] = std::uint8_t(bytes[at + c]);
    } else if (size == 2) {
        const std::uint32_t pixel = little_endian(bytes, at, 2);
        for (unsigned c = 0; c < 3; ++c) to[c] = std::uint8_t((pixel >> (10 - 5 * c) & 31) * 255 / 31);
    } else {
        for (std::size_t c = 0; c < 3; ++c) to[c] = std::uint8_t(bytes[at + 2 - c]);
        if (channels == 4) to[3] = std::uint8_t(bytes[at + 3]);
    }
}

/// The pixels as they are stored, without runs; fewer if the file is cut off.
std::string without_runs(std::string_view rest, std::size_t count, std::size_t size) {
    std::string plain;
    plain.reserve(count * size);
    while (plain.size() < count * size && !rest.empty()) {
        const std::size_t head = std::uint8_t(rest[0]), repeats = (head & 127) + 1, stored = head & 128 ? 1 : repeats;
        if (rest.size() < 1 + stored * size) break;
        for (std::size_t i = 0; i < repeats / stored; ++i) plain += rest.substr(1, stored * size);
        rest.remove_prefix(1 + stored * size);
    }
    return plain;
}

}  // namespace

bool is_tga(std::string_view bytes) {
    if (bytes.size() < tga_header_bytes) return false;
    const Tga tga = header_of(bytes);
    if (little_endian(bytes, 1, 1) > 1 || little_endian(bytes, 2, 1) > 11 || tga.width == 0 || tga.height == 0)
        return false;
    switch (tga.kind) {
        case mapped:
            return tga.has_map && tga.map_length > 0 && (tga.bits == 8 || tga.bits == 16) &&
                   (tga.map_bits == 8 || is_color_depth(tga.map_bits));
        case colors: return is_color_depth(tga.bits);
        case grey: return tga.bits == 8 || tga.bits == 16;
        default: return false;
    }
}

std::string read_tga_header(std::string_view bytes, ImageShape& shape) {
    if (!is_tga(bytes)) return "its header is damaged";
    const Tga tga = header_of(bytes);
    shape.width = unsigned(tga.width), shape.height = unsigned(tga.height), shape.channels = tga.channels();
    constexpr std::uint64_t most_in_run = 128;
    const std::uint64_t count = std::uint64_t(tga.width) * tga.height;
    shape.least_bytes =
        tga.pixels() + (tga.has_runs ? count / most_in_run * (1 + tga.pixel_bytes()) : count * tga.pixel_bytes());
    return {};
}

std::string read_tga_pixels(std::string_view bytes, const ImageShape& shape, Values& values) {
    const Tga tga = header_of(bytes);
    const std::size_t count = tga.width * tga.height, size = tga.pixel_bytes(), n = shape.channels;
    std::string_view pixels = bytes.substr(std::min(tga.pixels(), bytes.size()));
    std::string plain;
    if (tga.has_runs) pixels = plain = without_runs(pixels, count, size);
    if (pixels.size() < count * size || tga.pixels() > bytes.size()) return "it is cut off";
    values.resize(count * n);
    const bool from_right = (tga.descriptor & 0x10) != 0, from_top = (tga.descriptor & 0x20) != 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t x = i % tga.width, y = i / tga.width;
        const std::size_t row = from_top ? y : tga.height - 1 - y, column = from_right ? tga.width - 1 - x : x;
        std::uint8_t* const to = &values[(row * tga.width + column) * n];
        if (tga.kind == mapped) {
            const std::size_t index = little_endian(pixels, i * size, unsigned(size)) - tga.map_first;
            const std::size_t entry = index < tga.map_length ? index : 0;
            put_color(bytes, tga.map + entry * tga.entry_bytes(), shape.channels, tga.entry_bytes(), to);
        } else {
            put_color(pixels, i * size, shape.channels, size, to);
        }
    }
    if (const bool tells_alpha = (tga.descriptor & 15) != 0; n == 4 && !tells_alpha) fill_empty_alpha(values);
    return {};
}

}  // namespace claray
