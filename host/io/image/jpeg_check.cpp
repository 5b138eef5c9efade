#include "host/io/image/jpeg_check.hpp"

#include <cstddef>
#include <cstdint>

namespace claray {
namespace {

/// Bytes one after the other; 0 behind the end, as stb_image reads on.
class JpegReader {
public:
    explicit JpegReader(std::string_view bytes) : bytes_(bytes) {}
    [[nodiscard]] bool at_end() const { return next_ >= bytes_.size(); }
    unsigned byte() { return at_end() ? 0u : std::uint8_t(bytes_[next_++]); }
    void skip(std::size_t count) { next_ = count < bytes_.size() - next_ ? next_ + count : bytes_.size(); }

    /// The next marker (ITU-T T.81, B.1.1.2): 0xff, again and again, and a byte that is neither 0 nor a restart.
    unsigned marker() {
        while (!at_end()) {
            if (byte() != 0xff) continue;
            unsigned code = 0xff;
            while (code == 0xff && !at_end()) code = byte();
            if (code != 0 && code != 0xff && !(code >= 0xd0 && code <= 0xd8)) return code;
        }
        return 0;
    }

private:
    std::string_view bytes_;
    std::size_t next_ = 0;
};

/// The tables of one DHT segment (B.2.4.2): a class, 16 counts of codes, the codes' values.
bool tables_fit(JpegReader& in, int length) {
    while (length > 0) {
        static_cast<void>(in.byte());
        unsigned codes = 0;
        for (int i = 0; i < 16; ++i) codes += in.byte();
        if (codes > 256) return false;
        in.skip(codes);
        length -= 17 + int(codes);
    }
    return true;
}

}  // namespace

bool jpeg_tables_fit(std::string_view bytes) {
    JpegReader in(bytes);
    constexpr unsigned define_huffman_table = 0xc4, end_of_image = 0xd9;
    for (unsigned marker = in.marker(); marker != 0 && marker != end_of_image; marker = in.marker()) {
        const unsigned high = in.byte(), length = high << 8 | in.byte();
        if (length < 2) return true;  // stb_image stops here, too
        if (marker == define_huffman_table) {
            if (!tables_fit(in, int(length) - 2)) return false;
        } else {
            in.skip(length - 2);
        }
    }
    return true;
}

}  // namespace claray
