// PNG through libpng.
#include <png.h>

#include <bit>
#include <csetjmp>

#include "host/io/image/write/encode.hpp"

namespace claray {
namespace {

/// libpng reports errors by a jump: what `write` calls holds no object that has a destructor.
class PngWriter {
public:
    PngWriter() {
        png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
        info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    }
    ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    [[nodiscard]] std::string write(unsigned width, unsigned height, unsigned channels, unsigned bits,
                                    const std::uint8_t* texels) {
        if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return {};
        write_step(width, height, channels, bits, texels);
        return std::move(bytes_);
    }

private:
    void write_step(unsigned width, unsigned height, unsigned channels, unsigned bits, const std::uint8_t* texels) {
        constexpr int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                 PNG_COLOR_TYPE_RGB_ALPHA};
        png_set_write_fn(png_, this, on_write, nullptr);
        png_set_IHDR(png_, info_, width, height, int(bits), types[channels - 1], PNG_INTERLACE_NONE,
                     PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        png_write_info(png_, info_);
        if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png_);
        for (unsigned y = 0; y < height; ++y) png_write_row(png_, texels + y * png_get_rowbytes(png_, info_));
        png_write_end(png_, nullptr);
    }

    static void on_write(png_structp png, png_bytep bytes, std::size_t count) {
        auto* const writer = static_cast<PngWriter*>(png_get_io_ptr(png));
        writer->bytes_.append(reinterpret_cast<const char*>(bytes), count);
    }

    std::string bytes_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

}  // namespace

std::string encode_png(unsigned width, unsigned height, unsigned channels, std::span<const std::uint8_t> texels,
                       unsigned bits) {
    return PngWriter().write(width, height, channels, bits, texels.data());
}

}  // namespace claray
