// The format is in "Bitmap Storage" and "Bitmap Compression" (Microsoft, Win32 documentation).
#include "host/io/image/formats/bmp.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "host/io/image/formats/empty_alpha.hpp"
#include "host/io/little_endian.hpp"

namespace claray {
namespace {

using Color = std::array<std::uint8_t, 3>;
using Values = std::vector<std::uint8_t>;

enum Compression : std::uint32_t { plain = 0, rle8 = 1, rle4 = 2, masks_in_file = 3, masks_and_alpha_in_file = 6 };

struct Bmp {
    std::size_t pixels = 0;  ///< the byte at which they begin
    std::size_t width = 0, height = 0, bits = 0;
    bool from_top = false;
    std::uint32_t compression = plain;
    std::array<std::uint32_t, 4> masks{};  ///< of red, green, blue and alpha
    bool alpha_may_be_padding = false;
    std::vector<Color> palette;

    [[nodiscard]] bool has_runs() const { return compression == rle8 || compression == rle4; }
    [[nodiscard]] std::size_t row_bytes() const { return (width * bits + 31) / 32 * 4; }
    /// The padding of the last row may be missing.
    [[nodiscard]] std::uint64_t end() const { return pixels + row_bytes() * (height - 1) + (width * bits + 7) / 8; }
};

constexpr std::size_t file_header = 14;

std::string unsupported(const Bmp& bmp) {
    const auto is_one_of = [&](std::initializer_list<std::size_t> known) {
        return std::find(known.begin(), known.end(), bmp.bits) != known.end();
    };
    const bool fits = bmp.compression == plain  ? is_one_of({1, 2, 4, 8, 16, 24, 32})
                      : bmp.compression == rle8 ? bmp.bits == 8
                      : bmp.compression == rle4 ? bmp.bits == 4
                      : bmp.compression == masks_in_file || bmp.compression == masks_and_alpha_in_file
                          ? is_one_of({16, 32})
                          : false;
    if (fits) return {};
    return "its compression " + std::to_string(bmp.compression) + " with " + std::to_string(bmp.bits) +
           " bits a pixel is not supported";
}

/// What says how a pixel of 16, 24 or 32 bits is made. Returns the bytes that masks take behind the header.
std::size_t read_masks(std::string_view bytes, std::size_t header, Bmp& bmp) {
    bmp.masks = bmp.bits == 16 ? std::array<std::uint32_t, 4>{0x7c00, 0x3e0, 0x1f, 0}
                               : std::array<std::uint32_t, 4>{0xff0000, 0xff00, 0xff, bmp.bits == 32 ? 0xff000000u : 0};
    bmp.alpha_may_be_padding = true;
    if (bmp.compression != masks_in_file && bmp.compression != masks_and_alpha_in_file) return 0;
    const bool are_in_header = header >= 52, has_alpha = header >= 56 || bmp.compression == masks_and_alpha_in_file;
    for (std::size_t i = 0; i < 4; ++i)
        bmp.masks[i] = i == 3 && !has_alpha ? 0 : little_endian(bytes, file_header + 40 + 4 * i, 4);
    bmp.alpha_may_be_padding = false;
    return are_in_header ? 0 : has_alpha ? 16 : 12;
}

/// `told` is the number of colours that the header tells, 0 for all.
void read_palette(std::string_view bytes, std::size_t begin, std::size_t entry, std::size_t told, Bmp& bmp) {
    const std::size_t all = bmp.bits <= 8 ? std::size_t(1) << bmp.bits : 0;
    const std::size_t wanted = told > 0 ? std::min(told, all) : all;
    if (bmp.pixels < begin) bmp.pixels = begin + entry * wanted;
    const std::size_t end = std::min(bmp.pixels, bytes.size());
    for (std::size_t at = begin; bmp.palette.size() < wanted && at + entry <= end; at += entry)
        bmp.palette.push_back({std::uint8_t(bytes[at + 2]), std::uint8_t(bytes[at + 1]), std::uint8_t(bytes[at])});
}

/// Returns what is wrong.
std::string read(std::string_view bytes, Bmp& bmp) {
    const std::size_t header = little_endian(bytes, 14, 4);
    if (header < 12 || header > 1024) return "its header is damaged";
    if (bytes.size() < file_header + header) return "it is cut off";
    const bool is_first_of_os2 = header == 12;
    const auto field = [&](std::size_t at, unsigned count) {  // 0 for those that an older header does not have
        return at + count <= file_header + header ? little_endian(bytes, at, count) : 0u;
    };
    bmp.pixels = little_endian(bytes, 10, 4);
    const auto width = is_first_of_os2 ? std::int32_t(field(18, 2)) : std::int32_t(field(18, 4));
    const auto height = is_first_of_os2 ? std::int32_t(field(20, 2)) : std::int32_t(field(22, 4));
    bmp.from_top = height < 0;
    bmp.width = std::size_t(std::max(width, 0));
    bmp.height = std::size_t(bmp.from_top ? -std::int64_t(height) : height);
    bmp.bits = is_first_of_os2 ? field(24, 2) : field(28, 2);
    bmp.compression = field(30, 4);
    if (std::string fault = unsupported(bmp); !fault.empty()) return fault;
    const std::size_t begin = file_header + header + read_masks(bytes, header, bmp);
    read_palette(bytes, begin, is_first_of_os2 ? 3 : 4, field(46, 4), bmp);
    return bmp.bits <= 8 && bmp.palette.empty() ? "it has no palette" : "";
}

/// The indices of the pixels into the palette, row by row as they are stored.
class Indices {
public:
    Indices(std::size_t width, std::size_t height) : values(width * height, 0), width_(width), height_(height) {}

    void set(std::uint8_t index) {
        if (x_ < width_ && y_ < height_) values[y_ * width_ + x_] = index;
        ++x_;
    }
    void move(std::size_t right, std::size_t up) { x_ += right, y_ += up; }
    void next_row() { x_ = 0, ++y_; }

    Values values;

private:
    std::size_t width_, height_, x_ = 0, y_ = 0;
};

/// Pixel i of the packed bytes from `at`.
std::uint8_t unpacked(std::string_view bytes, std::size_t at, std::size_t i, std::size_t bits) {
    const std::size_t bit = i * bits;
    return std::uint8_t(std::uint8_t(bytes[at + bit / 8]) >> (8 - bits - bit % 8) & ((1u << bits) - 1));
}

void expand(std::string_view rest, std::size_t bits, Indices& to) {
    while (rest.size() >= 2) {
        const std::size_t count = std::uint8_t(rest[0]), value = std::uint8_t(rest[1]);
        if (count > 0)
            for (std::size_t i = 0; i < count; ++i) to.set(unpacked(rest, 1, i % (8 / bits), bits));
        rest.remove_prefix(2);
        if (count > 0) continue;
        if (value == 0) {
            to.next_row();
        } else if (value == 1) {
            return;
        } else if (value == 2) {
            if (rest.size() < 2) return;
            to.move(std::uint8_t(rest[0]), std::uint8_t(rest[1]));
            rest.remove_prefix(2);
        } else {  // pixels as they are, padded to 2 bytes
            if (rest.size() * 8 < value * bits) return;
            for (std::size_t i = 0; i < value; ++i) to.set(unpacked(rest, 0, i, bits));
            rest.remove_prefix(std::min((value * bits + 15) / 16 * 2, rest.size()));
        }
    }
}

Values indices_of(std::string_view bytes, const Bmp& bmp) {
    Indices indices(bmp.width, bmp.height);
    if (bmp.has_runs()) {
        expand(bytes.substr(bmp.pixels), bmp.bits, indices);
    } else {
        for (std::size_t y = 0; y < bmp.height; ++y, indices.next_row())
            for (std::size_t x = 0; x < bmp.width; ++x)
                indices.set(unpacked(bytes, bmp.pixels + y * bmp.row_bytes(), x, bmp.bits));
    }
    return std::move(indices.values);
}

/// The bits of a mask, scaled to 0..255 and rounded.
std::uint8_t masked(std::uint32_t pixel, std::uint32_t mask) {
    if (mask == 0) return 0;
    const int shift = std::countr_zero(mask);
    const std::uint64_t most = mask >> shift, value = (pixel & mask) >> shift;
    return std::uint8_t((value * 255 + most / 2) / most);
}

}  // namespace

bool is_bmp(std::string_view bytes) { return bytes.size() > file_header + 4 && bytes.starts_with("BM"); }

std::string read_bmp_header(std::string_view bytes, ImageShape& shape) {
    Bmp bmp;
    if (std::string fault = read(bytes, bmp); !fault.empty()) return fault;
    shape.width = unsigned(bmp.width), shape.height = unsigned(bmp.height);
    shape.channels = bmp.masks[3] != 0 && bmp.bits > 8 ? 4 : 3;
    constexpr std::uint64_t most_packed = 4096;  // pixels a byte of runs
    shape.least_bytes =
        !bmp.has_runs() && bmp.height > 0 ? bmp.end() : bmp.pixels + bmp.width * bmp.height / most_packed;
    return {};
}

std::string read_bmp_pixels(std::string_view bytes, const ImageShape& shape, Values& values) {
    Bmp bmp;
    if (std::string fault = read(bytes, bmp); !fault.empty()) return fault;
    const std::size_t n = shape.channels;
    values.resize(bmp.width * bmp.height * n);
    const Values indices = bmp.bits <= 8 ? indices_of(bytes, bmp) : Values();
    for (std::size_t y = 0; y < bmp.height; ++y)
        for (std::size_t x = 0; x < bmp.width; ++x) {
            std::uint8_t* const to = &values[((bmp.from_top ? y : bmp.height - 1 - y) * bmp.width + x) * n];
            if (bmp.bits <= 8) {
                const std::size_t index = indices[y * bmp.width + x];
                const Color color = index < bmp.palette.size() ? bmp.palette[index] : Color{};
                std::copy(color.begin(), color.end(), to);
            } else {
                const std::size_t size = bmp.bits / 8;
                const std::uint32_t pixel =
                    little_endian(bytes, bmp.pixels + y * bmp.row_bytes() + x * size, unsigned(size));
                for (std::size_t c = 0; c < n; ++c) to[c] = masked(pixel, bmp.masks[c]);
            }
        }
    if (n == 4 && bmp.alpha_may_be_padding) fill_empty_alpha(values);
    return {};
}

}  // namespace claray
