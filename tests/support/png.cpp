#include "tests/support/png.hpp"

#include <algorithm>

namespace claray::test {
namespace {

std::string big_endian(std::uint32_t value) {
    return {char(value >> 24), char(value >> 16 & 255), char(value >> 8 & 255), char(value & 255)};
}

std::uint32_t adler32(std::string_view bytes) {
    std::uint32_t a = 1, b = 0;
    for (const char c : bytes) a = (a + std::uint8_t(c)) % 65521, b = (b + a) % 65521;
    return b << 16 | a;
}

/// Bits from the least of each byte on (RFC 1951, section 3.1.1).
class Bits {
public:
    void put(std::uint32_t value, unsigned count) {
        for (unsigned i = 0; i < count; ++i) {
            if (used_ == 0) bytes_ += '\0';
            bytes_.back() = char(std::uint8_t(bytes_.back()) | (value >> i & 1) << used_);
            used_ = (used_ + 1) % 8;
        }
    }
    /// A Huffman code, whose most significant bit comes first.
    void put_code(std::uint32_t code, unsigned count) {
        for (unsigned i = count; i-- > 0;) put(code >> i & 1, 1);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    unsigned used_ = 0;
};

struct Pass {
    unsigned x, y, dx, dy;
};
/// Adam7 (PNG, section 8.2).
constexpr Pass adam7[] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                          {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = ~0u;
    for (const char c : bytes) {
        crc ^= std::uint8_t(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
    }
    return ~crc;
}

std::string png_chunk(const std::string& type, const std::string& content) {
    return big_endian(std::uint32_t(content.size())) + type + content + big_endian(crc32(type + content));
}

std::string stored_zlib(std::string_view raw) {
    std::string stream = "\x78\x01";
    std::size_t at = 0;
    do {
        const std::size_t count = std::min<std::size_t>(raw.size() - at, 65535);
        const bool last = at + count == raw.size();
        for (const unsigned value : {unsigned(last), unsigned(count & 255), unsigned(count >> 8),
                                     ~unsigned(count) & 255, ~unsigned(count) >> 8 & 255})
            stream += char(value);
        stream += raw.substr(at, count);
        at += count;
    } while (at < raw.size());
    return stream + big_endian(adler32(raw));
}

// One zero, then runs of 258 bytes at distance 1 in the fixed code of RFC 1951, section 3.2.6.
std::string zeros_zlib(std::uint64_t count, std::uint8_t value) {
    Bits bits;
    bits.put(1, 1), bits.put(1, 2);  // last block, fixed code
    const std::uint64_t runs = (count - 1) / 258, rest = (count - 1) % 258;
    for (std::uint64_t i = 0; i < rest + 1; ++i) bits.put_code(0x30u + value, 8);
    for (std::uint64_t i = 0; i < runs; ++i) bits.put_code(0xc5, 8), bits.put_code(0, 5);
    bits.put_code(0, 7);
    const std::uint64_t n = count % (2 * 65521);  // Adler's sums, whose period that is
    const std::uint64_t low = (1 + value * n) % 65521, high = (n + value * (n * (n + 1) / 2 % 65521)) % 65521;
    return "\x78\x01" + bits.bytes() + big_endian(std::uint32_t(high << 16 | low));
}

void mend_png(std::vector<std::uint8_t>& file) {
    for (std::size_t at = 8; at + 12 <= file.size();) {
        std::uint32_t length = 0;
        for (std::size_t i = 0; i < 4; ++i) length = length << 8 | file[at + i];
        if (length > file.size() - at - 12) return;
        const std::string_view checked(reinterpret_cast<const char*>(&file[at + 4]), 4 + length);
        const std::string sum = big_endian(crc32(checked));
        std::copy(sum.begin(), sum.end(), file.begin() + std::ptrdiff_t(at + 8 + length));
        at += 12 + length;
    }
}

unsigned RawPng::channels() const {
    constexpr unsigned of[] = {1, 0, 3, 1, 2, 0, 4};
    return of[color_type];
}

std::string RawPng::raw() const {
    std::string rows;
    const auto add_pass = [&](const Pass& pass) {
        for (unsigned y = pass.y; y < height && pass.x < width; y += pass.dy) {
            rows += '\0';  // no filter
            unsigned bits = 0;
            for (unsigned x = pass.x; x < width; x += pass.dx)
                for (unsigned c = 0; c < channels(); ++c)
                    for (unsigned bit = depth; bit-- > 0; ++bits) {
                        if (bits % 8 == 0) rows += '\0';
                        const unsigned value = samples[(std::size_t(y) * width + x) * channels() + c] >> bit & 1u;
                        rows.back() = char(std::uint8_t(rows.back()) | value << (7 - bits % 8));
                    }
        }
    };
    if (interlaced)
        for (const Pass& pass : adam7) add_pass(pass);
    else
        add_pass({0, 0, 1, 1});
    return rows;
}

std::string RawPng::file_with(const std::string& pixels) const {
    std::string header = big_endian(width) + big_endian(height);
    for (const unsigned value : {depth, color_type, 0u, 0u, unsigned(interlaced)}) header += char(value);
    std::string file = "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header);
    if (!palette.empty()) file += png_chunk("PLTE", palette);
    if (!transparency.empty()) file += png_chunk("tRNS", transparency);
    return file + png_chunk("IDAT", pixels) + png_chunk("IEND", "");
}

}  // namespace claray::test
