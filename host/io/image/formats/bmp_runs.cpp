// The format is in "Bitmap Compression" (Microsoft, Win32 documentation).
#include "host/io/image/formats/bmp_runs.hpp"

#include <algorithm>
#include <cstdint>

namespace claray {
namespace {

constexpr std::size_t at_pixels = 10, at_width = 18, at_height = 22, at_bits = 28, at_compression = 30, header = 54;
constexpr std::uint32_t rle8 = 1, rle4 = 2;

std::uint32_t number_at(std::string_view bytes, std::size_t at, int count = 4) {
    std::uint32_t value = 0;
    for (int i = count; i-- > 0;) value = value << 8 | std::uint8_t(bytes[at + std::size_t(i)]);
    return value;
}

/// The indices of the pixels, row by row from the bottom; rows are padded to 4 bytes.
class Indices {
public:
    Indices(std::size_t width, std::size_t height, unsigned bits)
        : width_(width), height_(height), bits_(bits), row_((width * bits + 31) / 32 * 4), bytes(row_ * height, '\0') {}

    void set(std::uint32_t index) {
        if (x_ < width_ && y_ < height_) {
            char& byte = bytes[y_ * row_ + x_ * bits_ / 8];
            const bool is_high = bits_ == 4 && x_ % 2 == 0;
            byte = char(bits_ == 8 ? index : std::uint8_t(byte) | (index << (is_high ? 4 : 0)));
        }
        ++x_;
    }
    void move(std::size_t right, std::size_t up) { x_ += right, y_ += up; }
    void next_row() { x_ = 0, ++y_; }

private:
    std::size_t width_, height_, bits_, row_, x_ = 0, y_ = 0;

public:
    std::string bytes;
};

void expand(std::string_view rest, unsigned bits, Indices& to) {
    const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(rest[i])); };
    const auto index = [&](std::uint32_t from, std::size_t i) {  // of the pixel i in the bytes from `from`
        return bits == 8 ? from : i % 2 == 0 ? from >> 4 : from & 15;
    };
    while (rest.size() >= 2) {
        const std::uint32_t count = byte(0), value = byte(1);
        rest.remove_prefix(2);
        if (count > 0) {
            for (std::size_t i = 0; i < count; ++i) to.set(index(value, i));
        } else if (value == 0) {
            to.next_row();
        } else if (value == 1) {
            return;
        } else if (value == 2) {
            if (rest.size() < 2) return;
            to.move(byte(0), byte(1));
            rest.remove_prefix(2);
        } else {
            const std::size_t taken = (value * bits + 15) / 16 * 2;  // pixels as they are, padded to 2 bytes
            if (rest.size() * 8 < std::size_t(value) * bits) return;
            for (std::size_t i = 0; i < value; ++i) to.set(index(byte(i * bits / 8), i));
            rest.remove_prefix(std::min(taken, rest.size()));
        }
    }
}

unsigned bits_of(std::string_view bytes) { return number_at(bytes, at_compression) == rle8 ? 8 : 4; }

}  // namespace

bool is_bmp_of_runs(std::string_view bytes) {
    if (bytes.size() < header || !bytes.starts_with("BM") || number_at(bytes, 14) < 40) return false;
    const std::uint32_t compression = number_at(bytes, at_compression), bits = number_at(bytes, at_bits, 2);
    return (compression == rle8 && bits == 8) || (compression == rle4 && bits == 4);
}

std::size_t size_without_bmp_runs(std::string_view bytes) {
    const std::uint64_t width = number_at(bytes, at_width), height = number_at(bytes, at_height);
    constexpr std::uint64_t most = 1u << 30;
    const std::uint64_t pixels = number_at(bytes, at_pixels);
    if (width == 0 || height == 0 || width > most || height > most || pixels < header || pixels > bytes.size())
        return 0;
    const std::uint64_t row = (width * bits_of(bytes) + 31) / 32 * 4;
    return row > most / height ? 0 : std::size_t(pixels + row * height);
}

std::string without_bmp_runs(std::string_view bytes) {
    const std::size_t pixels = number_at(bytes, at_pixels);
    Indices indices(number_at(bytes, at_width), number_at(bytes, at_height), bits_of(bytes));
    expand(bytes.substr(pixels), bits_of(bytes), indices);
    std::string plain(bytes.substr(0, pixels));
    for (std::size_t i = 0; i < 4; ++i) plain[at_compression + i] = '\0';
    return plain + indices.bytes;
}

}  // namespace claray
