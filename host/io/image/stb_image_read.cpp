// The one translation unit that compiles stb_image; static, so that it can't clash with a copy in the host program.
#include "host/io/image/stb_image_read.hpp"

#include <algorithm>
#include <cstring>
#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wshadow"
#ifdef __clang_analyzer__  // memory that it takes for lost in stb_image is not ours to mend
void* opaque_malloc(std::size_t size);
void* opaque_realloc(void* memory, std::size_t size);
void opaque_free(void* memory);
#define STBI_MALLOC opaque_malloc
#define STBI_REALLOC opaque_realloc
#define STBI_FREE opaque_free
#endif
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_JPEG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#include <stb_image.h>
#pragma GCC diagnostic pop

namespace claray {
namespace {

/// Feeds the decoder and notices when it wants more than there is: it would take zeros for the rest and call that an
/// image. stb_image refills a buffer of 128 bytes, of which the last may be short; other short reads are asked for.
struct Source {
    std::string_view bytes;
    std::size_t next = 0;
    bool cut_off = false;

    static int read(void* user, char* data, int size) {
        Source& source = *static_cast<Source*>(user);
        constexpr int refill = 128;
        const int count = int(std::min(source.bytes.size() - source.next, std::size_t(size)));
        if (count == 0 || (count < size && size != refill)) source.cut_off = true;
        std::memcpy(data, source.bytes.data() + source.next, std::size_t(count));
        source.next += std::size_t(count);
        return count;
    }
    static void skip(void* user, int size) {
        Source& source = *static_cast<Source*>(user);
        const std::size_t left = source.bytes.size() - source.next;
        if (size > 0 && std::size_t(size) > left) source.cut_off = true;
        source.next = size >= 0 ? source.next + std::min(std::size_t(size), left)
                                : source.next - std::min(std::size_t(-std::int64_t(size)), source.next);
    }
    static int at_end(void* user) {
        const Source& source = *static_cast<const Source*>(user);
        return source.next >= source.bytes.size();
    }
};

constexpr stbi_io_callbacks callbacks = {Source::read, Source::skip, Source::at_end};

/// stb_image gives no reason for some broken files.
std::string reason(const Source& source) {
    if (source.cut_off) return "it is cut off";
    const char* const given = stbi_failure_reason();
    return given ? given : "it cannot be decoded";
}

/// Bit 4 of a TGA's descriptor: rows go from right to left. stb_image ignores it.
bool is_tga_from_right(std::string_view bytes) {
    constexpr std::size_t descriptor = 17;
    const bool is_other = bytes.starts_with("BM") || bytes.starts_with("\xff\xd8");
    return !is_other && bytes.size() > descriptor && (bytes[descriptor] & 0x10) != 0;
}

void mirror_rows(const ImageShape& shape, std::vector<std::uint8_t>& values) {
    const std::size_t n = shape.channels;
    for (std::size_t row = 0; row < values.size(); row += shape.width * n)
        for (std::size_t x = 0; x < shape.width / 2; ++x)
            std::swap_ranges(&values[row + x * n], &values[row + x * n] + n, &values[row + (shape.width - 1 - x) * n]);
}

}  // namespace

std::optional<ImageShape> image_shape(std::string_view bytes) {
    int width = 0, height = 0, channels = 0;
    Source source{bytes};
    if (!stbi_info_from_callbacks(&callbacks, &source, &width, &height, &channels) || width <= 0 || height <= 0 ||
        channels < 1 || channels > 4)
        return {};
    return ImageShape{unsigned(width), unsigned(height), unsigned(channels)};
}

std::string decode_image(std::string_view bytes, ImageShape& shape, std::vector<std::uint8_t>& values) {
    Source source{bytes};
    int width = 0, height = 0, channels = 0;
    stbi__g_failure_reason = nullptr;  // of an earlier image
    const std::unique_ptr<stbi_uc, void (*)(void*)> data(
        stbi_load_from_callbacks(&callbacks, &source, &width, &height, &channels, 0), stbi_image_free);
    if (!data || source.cut_off) return reason(source);
    if (unsigned(width) != shape.width || unsigned(height) != shape.height) return "its sizes contradict each other";
    shape.channels = unsigned(channels);
    values.assign(data.get(), data.get() + std::size_t(width) * std::size_t(height) * std::size_t(channels));
    if (is_tga_from_right(bytes)) mirror_rows(shape, values);
    return {};
}

}  // namespace claray
