#include "host/io/image/png_read.hpp"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

namespace claray {
namespace {

constexpr std::string_view signature("\x89PNG\r\n\x1a\n", 8);
constexpr const char* cut_off = "it is cut off";

/// libpng reports errors by a jump: what `attempt` calls holds no object that has a destructor.
class PngReader {
public:
    explicit PngReader(std::string_view bytes) : rest_(bytes) {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, [](png_structp, png_const_charp) {});
        info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    [[nodiscard]] std::string read_header(PngHeader& header) {
        return attempt([this, &header] { header_step(header); });
    }

    /// Rows from the top, one behind the other.
    [[nodiscard]] std::string read_pixels(unsigned char* pixels, std::size_t row_bytes) {
        return attempt([this, pixels, row_bytes] { pixels_step(pixels, row_bytes); });
    }

private:
    template <class Step>
    std::string attempt(const Step& step) {
        if (info_ == nullptr) return "there is not enough memory to read it";
        if (setjmp(png_jmpbuf(png_)) != 0) return error_ == "CRC error" ? "a checksum is wrong" : error_;
        step();
        return {};
    }

    void header_step(PngHeader& header) {
        png_set_read_fn(png_, this, on_read);
        png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
        // Profiles and texts, which may be compressed, too, are skipped.
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
        png_read_info(png_, info_);
        header.width = png_get_image_width(png_, info_), header.height = png_get_image_height(png_, info_);
        header.raw_bytes = std::uint64_t(header.height) * (1 + png_get_rowbytes(png_, info_));
        png_set_expand(png_);
        if (std::endian::native == std::endian::little) png_set_swap(png_);
        passes_ = png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        header.channels = png_get_channels(png_, info_);
        header.sixteen_bits = png_get_bit_depth(png_, info_) == 16;
    }

    /// Each pass of an interlaced image fills its own pixels of the rows.
    void pixels_step(unsigned char* pixels, std::size_t row_bytes) {
        const png_uint_32 height = png_get_image_height(png_, info_);
        for (int pass = 0; pass < passes_; ++pass)
            for (png_uint_32 y = 0; y < height; ++y) png_read_row(png_, pixels + y * row_bytes, nullptr);
        png_read_end(png_, nullptr);
    }

    [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
        static_cast<PngReader*>(png_get_error_ptr(png))->error_ = message;
        png_longjmp(png, 1);
    }

    static void on_read(png_structp png, png_bytep to, std::size_t count) {
        PngReader& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
        if (count > reader.rest_.size()) png_error(png, cut_off);
        std::memcpy(to, reader.rest_.data(), count);
        reader.rest_.remove_prefix(count);
    }

    std::string_view rest_;
    std::string error_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    int passes_ = 1;
};

/// The words are the upper half of the floats' memory: each float is written where all words have been read.
void words_to_floats(std::vector<float>& floats) {
    const auto* words = reinterpret_cast<const unsigned char*>(floats.data()) + floats.size() * sizeof(std::uint16_t);
    for (std::size_t i = 0; i < floats.size(); ++i) {
        std::uint16_t word = 0;
        std::memcpy(&word, words + i * sizeof word, sizeof word);
        floats[i] = float(word) / 65535.f;
    }
}

}  // namespace

bool is_png(std::string_view bytes) { return bytes.substr(0, signature.size()) == signature; }

std::string read_png_header(std::string_view bytes, PngHeader& header) { return PngReader(bytes).read_header(header); }

std::string read_png(std::string_view bytes, const PngHeader& header, Texture& texture) {
    PngReader reader(bytes);
    PngHeader again;
    std::string fault = reader.read_header(again);
    if (!fault.empty()) return fault;
    texture.width = header.width, texture.height = header.height, texture.channels = header.channels;
    const std::size_t row = std::size_t(header.width) * header.channels, values = row * header.height;
    if (!header.sixteen_bits) {
        texture.bytes.resize(values);
        return reader.read_pixels(texture.bytes.data(), row);
    }
    texture.floats.resize(values);
    auto* const words = reinterpret_cast<unsigned char*>(texture.floats.data()) + values * sizeof(std::uint16_t);
    fault = reader.read_pixels(words, row * sizeof(std::uint16_t));
    words_to_floats(texture.floats);
    return fault;
}

}  // namespace claray
