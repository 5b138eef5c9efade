#include "host/io/image/jpeg_read.hpp"

#include <csetjmp>
#include <cstddef>
#include <cstdio>  // which jpeglib.h needs

#include <jpeglib.h>

#include <jerror.h>

namespace claray {
namespace {

constexpr std::uint64_t most_packed = 4096;  // pixels a byte: a block of 64 takes 6 bits at least, and fewer in runs

/// libjpeg reports errors by a jump: what `attempt` calls holds no object that has a destructor.
class JpegReader {
public:
    explicit JpegReader(std::string_view bytes) : bytes_(bytes) {
        jpeg_.err = jpeg_std_error(&errors_);
        jpeg_.client_data = this;
        errors_.error_exit = on_error, errors_.emit_message = on_message;
        progress_.progress_monitor = on_progress;
    }
    ~JpegReader() { jpeg_destroy_decompress(&jpeg_); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    [[nodiscard]] std::string read_header(ImageShape& shape) {
        return attempt([this, &shape] { header_step(shape); });
    }
    [[nodiscard]] std::string read_pixels(const ImageShape& shape, std::uint8_t* pixels, std::uint8_t* row) {
        return attempt([this, &shape, pixels, row] { pixels_step(shape, pixels, row); });
    }
    [[nodiscard]] bool is_cmyk() const { return jpeg_.out_color_space == JCS_CMYK; }

private:
    template <class Step>
    std::string attempt(const Step& step) {
        if (setjmp(jump_) == 0) step();
        return fault_;
    }

    void header_step(ImageShape& shape) {
        jpeg_create_decompress(&jpeg_);
        jpeg_.progress = &progress_;
        jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes_.data()), bytes_.size());
        jpeg_read_header(&jpeg_, TRUE);
        shape.width = jpeg_.image_width, shape.height = jpeg_.image_height;
        shape.channels = jpeg_.num_components == 1 ? 1 : 3;
        shape.least_bytes = std::uint64_t(shape.width) * shape.height / most_packed;
        if (jpeg_.num_components == 2 || jpeg_.num_components > 4) fail("its colours are unknown");
    }

    /// libjpeg converts YCCK to CMYK, and leaves CMYK to its user.
    void pixels_step(const ImageShape& shape, std::uint8_t* pixels, std::uint8_t* row) {
        const std::size_t row_values = std::size_t(shape.width) * shape.channels;
        jpeg_start_decompress(&jpeg_);
        while (jpeg_.output_scanline < jpeg_.output_height) {
            std::uint8_t* const to = pixels + jpeg_.output_scanline * row_values;
            JSAMPROW into = is_cmyk() ? row : to;
            jpeg_read_scanlines(&jpeg_, &into, 1);
            if (!is_cmyk()) continue;
            for (std::size_t x = 0; x < shape.width; ++x)
                for (std::size_t c = 0; c < 3; ++c) {
                    // Programs store the share of the paper that the ink leaves white.
                    const unsigned product = row[4 * x + c] * row[4 * x + 3];
                    to[3 * x + c] = std::uint8_t((product + 127) / 255);
                }
        }
        jpeg_finish_decompress(&jpeg_);
    }

    [[noreturn]] void fail(const char* reason) {
        fault_ = reason;
        std::longjmp(jump_, 1);
    }
    static JpegReader& of(j_common_ptr jpeg) { return *static_cast<JpegReader*>(jpeg->client_data); }

    [[noreturn]] static void on_error(j_common_ptr jpeg) {
        char text[JMSG_LENGTH_MAX];
        jpeg->err->format_message(jpeg, text);
        of(jpeg).fail(text);
    }

    /// Warnings of pixels that libjpeg had to make up. Some cameras and programs end the data of a file early, which
    /// all programs show: JWRN_HIT_MARKER is ignored.
    static void on_message(j_common_ptr jpeg, int level) {
        if (level >= 0) return;
        switch (jpeg->err->msg_code) {
            case JWRN_JPEG_EOF: of(jpeg).fail("it is cut off");
            case JWRN_HUFF_BAD_CODE:
            case JWRN_ARITH_BAD_CODE:
            case JWRN_MUST_RESYNC: on_error(jpeg);
            default: return;
        }
    }

    /// Each scan of a progressive image goes over all its pixels, however few bytes it has.
    static void on_progress(j_common_ptr jpeg) {
        constexpr int most_scans = 500;
        const auto* const decoder = reinterpret_cast<j_decompress_ptr>(jpeg);
        if (decoder->input_scan_number > most_scans) of(jpeg).fail("it has more than 500 scans");
    }

    std::string_view bytes_;
    std::string fault_;
    std::jmp_buf jump_;
    jpeg_error_mgr errors_{};
    jpeg_progress_mgr progress_{};
    jpeg_decompress_struct jpeg_{};
};

}  // namespace

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8"); }

std::string read_jpeg_header(std::string_view bytes, ImageShape& shape) { return JpegReader(bytes).read_header(shape); }

std::string read_jpeg_pixels(std::string_view bytes, const ImageShape& shape, std::vector<std::uint8_t>& values) {
    JpegReader reader(bytes);
    ImageShape again;
    std::string fault = reader.read_header(again);
    if (!fault.empty()) return fault;
    values.resize(std::size_t(shape.width) * shape.height * shape.channels);
    std::vector<std::uint8_t> row(reader.is_cmyk() ? std::size_t(shape.width) * 4 : 0);
    return reader.read_pixels(shape, values.data(), row.data());
}

}  // namespace claray
