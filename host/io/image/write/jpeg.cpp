// JPEG through libjpeg.
#include <csetjmp>
#include <cstddef>
#include <cstdio>  // which jpeglib.h needs
#include <cstdlib>

#include <jpeglib.h>

#include "host/io/image/write/encode.hpp"

namespace claray {
namespace {

constexpr unsigned most_with_coarse_colors = 90;

/// libjpeg reports errors by a jump: what `write` calls holds no object that has a destructor.
class JpegWriter {
public:
    JpegWriter() {
        jpeg_.err = jpeg_std_error(&errors_);
        jpeg_.client_data = this;
        errors_.error_exit = [](j_common_ptr jpeg) {
            std::longjmp(static_cast<JpegWriter*>(jpeg->client_data)->jump_, 1);
        };
    }
    ~JpegWriter() {
        jpeg_destroy_compress(&jpeg_);
        std::free(bytes_);
    }
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;

    [[nodiscard]] std::string write(unsigned width, unsigned height, unsigned channels, const std::uint8_t* pixels,
                                    unsigned quality, std::uint8_t* row) {
        if (setjmp(jump_) != 0) return {};
        write_step(width, height, channels, pixels, quality, row);
        return {reinterpret_cast<const char*>(bytes_), size_};
    }

private:
    void write_step(unsigned width, unsigned height, unsigned channels, const std::uint8_t* pixels, unsigned quality,
                    std::uint8_t* row) {
        jpeg_create_compress(&jpeg_);
        jpeg_mem_dest(&jpeg_, &bytes_, &size_);
        jpeg_.image_width = width, jpeg_.image_height = height;
        jpeg_.input_components = 3, jpeg_.in_color_space = JCS_RGB;
        jpeg_set_defaults(&jpeg_);
        jpeg_set_quality(&jpeg_, int(quality), TRUE);
        if (quality > most_with_coarse_colors) jpeg_.comp_info[0].h_samp_factor = jpeg_.comp_info[0].v_samp_factor = 1;
        jpeg_start_compress(&jpeg_, TRUE);
        for (const std::uint8_t* pixel = pixels; jpeg_.next_scanline < height;) {
            for (std::size_t x = 0; x < width; ++x, pixel += channels)
                for (std::size_t c = 0; c < 3; ++c) row[3 * x + c] = pixel[c];
            jpeg_write_scanlines(&jpeg_, &row, 1);
        }
        jpeg_finish_compress(&jpeg_);
    }

    std::jmp_buf jump_;
    jpeg_error_mgr errors_{};
    jpeg_compress_struct jpeg_{};
    unsigned char* bytes_ = nullptr;  // of malloc
    unsigned long size_ = 0;
};

}  // namespace

std::string encode_jpeg(unsigned width, unsigned height, unsigned channels, std::span<const std::uint8_t> pixels,
                        unsigned quality) {
    std::vector<std::uint8_t> row(std::size_t(width) * 3);
    return JpegWriter().write(width, height, channels, pixels.data(), quality, row.data());
}

}  // namespace claray
