// Image files in: PNG through libpng, JPEG through libjpeg, WebP through libwebp, EXR through libOpenEXR, and those
// that claray reads itself.
#include "host/io/image/image_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/image/exr.hpp"
#include "host/io/image/formats/bmp.hpp"
#include "host/io/image/formats/other_formats.hpp"
#include "host/io/image/formats/radiance.hpp"
#include "host/io/image/formats/tga.hpp"
#include "host/io/image/jpeg_read.hpp"
#include "host/io/image/ktx2_read.hpp"
#include "host/io/image/png_read.hpp"
#include "host/io/image/webp_read.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using std::to_string;

[[noreturn]] void refuse(const std::string& what, const std::string& why, const std::string& remedy) {
    throw Error(ErrorKind::user, "cannot read " + what + ": " + why, remedy);
}

void check_bytes(const std::string& what, std::uint64_t width, std::uint64_t height, std::uint64_t texel_bytes,
                 std::size_t room) {
    const std::string size = to_string(width) + "x" + to_string(height);
    if (width == 0 || height == 0) refuse(what, "its size is " + size, "export it again");
    if (width > largest_image_side || height > largest_image_side)
        refuse(what, "its size is " + size + ", the maximum is " + to_string(largest_image_side) + " pixels per side",
               "scale it down");
    const std::uint64_t bytes = width * height * texel_bytes;
    if (bytes > room)
        refuse(what,
               size + " take " + to_string(bytes) + " bytes of memory, and " + to_string(room) +
                   " remain of the limit of " + to_string(largest_image_bytes),
               "scale the images down");
}

/// So that a few broken bytes can't ask for a gigabyte: `packed_bytes` is the least that the pixels of this size take.
void check_plausible(const std::string& what, std::uint64_t width, std::uint64_t height, std::uint64_t packed_bytes,
                     std::size_t file_bytes) {
    if (packed_bytes > file_bytes)
        refuse(what,
               "it is cut off: " + to_string(file_bytes) + " bytes for " + to_string(width) + "x" + to_string(height),
               "export it again");
}

float linear_from_srgb16(float value) {
    return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

/// Alpha, the last of 2 or 4 channels, is linear already.
void make_linear(Texture& texture) {
    for (std::size_t i = 0; i < texture.floats.size(); ++i) {
        const bool alpha = texture.channels % 2 == 0 && i % texture.channels == texture.channels - 1;
        if (!alpha) texture.floats[i] = linear_from_srgb16(texture.floats[i]);
    }
}

/// The next word of a PFM's header.
std::string_view word(std::string_view& rest) {
    const auto blank = [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
    std::size_t begin = 0;
    while (begin < rest.size() && blank(rest[begin])) ++begin;
    std::size_t end = begin;
    while (end < rest.size() && !blank(rest[end])) ++end;
    const std::string_view found = rest.substr(begin, end - begin);
    rest.remove_prefix(end);
    return found;
}

template <class T>
T number(std::string_view text, const std::string& what) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty())
        refuse(what, "its PFM header is damaged", "export it again");
    return value;
}

void swap_bytes(std::vector<float>& values) {
    for (float& value : values) {
        auto bytes = std::bit_cast<std::array<char, sizeof(float)>>(value);
        std::reverse(bytes.begin(), bytes.end());
        value = std::bit_cast<float>(bytes);
    }
}

bool is_pfm(std::string_view bytes) {
    return bytes.size() > 3 && bytes[0] == 'P' && (bytes[1] == 'F' || bytes[1] == 'f') &&
           (bytes[2] == '\n' || bytes[2] == '\r' || bytes[2] == ' ');
}

/// Portable float map (Debevec): three words, one blank, rows from the bottom up; a negative scale says little endian,
/// and its size multiplies the values.
Texture decode_pfm(std::string_view bytes, const std::string& what, std::size_t room) {
    Texture texture;
    texture.format = TexelFormat::float32;
    texture.channels = bytes[1] == 'F' ? 3 : 1;
    std::string_view rest = bytes.substr(2);
    texture.width = number<unsigned>(word(rest), what);
    texture.height = number<unsigned>(word(rest), what);
    const float scale = number<float>(word(rest), what);
    if (scale == 0.f || !std::isfinite(scale)) refuse(what, "its PFM header is damaged", "export it again");
    check_bytes(what, texture.width, texture.height, texture.channels * sizeof(float), room);
    const std::size_t row = std::size_t(texture.width) * texture.channels;
    if (rest.size() < 1 + row * texture.height * sizeof(float)) refuse(what, "it is cut off", "export it again");
    texture.floats.resize(row * texture.height);
    const char* in = rest.data() + 1;
    for (unsigned y = texture.height; y-- > 0; in += row * sizeof(float))
        std::memcpy(texture.floats.data() + y * row, in, row * sizeof(float));
    if ((scale < 0.f) != (std::endian::native == std::endian::little)) swap_bytes(texture.floats);
    if (const float unit = std::abs(scale); unit != 1.f)
        for (float& value : texture.floats) value *= unit;
    return texture;
}

Texture decode_exr(std::string_view bytes, const std::string& what, std::size_t room) {
    ExrShape shape;
    std::string fault = read_exr_shape(bytes, shape);
    if (!fault.empty()) refuse(what, fault, "export it again, or convert it to HDR");
    check_bytes(what, shape.width, shape.height, shape.channels * sizeof(float), room);
    check_bytes(what, shape.stored_width, shape.stored_height, shape.channels * sizeof(float), room);
    constexpr std::uint64_t most_packed = 4096;  // as for others; an empty part of a film packs less tightly
    check_plausible(what, shape.stored_width, shape.stored_height,
                    std::uint64_t(shape.stored_width) * shape.stored_height / most_packed, bytes.size());
    Texture texture;
    texture.width = shape.width, texture.height = shape.height, texture.channels = shape.channels;
    texture.format = TexelFormat::float32;
    fault = read_exr_pixels(bytes, shape, texture.floats);
    if (!fault.empty()) refuse(what, "the image is damaged (" + fault + ")", "export it again");
    return texture;
}

/// 16 bits a channel keep their precision as linear floats.
Texture decode_png(std::string_view bytes, const std::string& what, TexelFormat eight_bit, std::size_t room) {
    const auto check = [&](const std::string& fault) {
        if (!fault.empty()) refuse(what, "the image is damaged (" + fault + ")", "export it again");
    };
    PngHeader header;
    check(read_png_header(bytes, header));
    check_bytes(what, header.width, header.height, header.channels * (header.sixteen_bits ? sizeof(float) : 1), room);
    constexpr std::uint64_t most_packed = 1032;  // of deflate
    check_plausible(what, header.width, header.height, header.raw_bytes / most_packed, bytes.size());
    Texture texture;
    texture.format = header.sixteen_bits ? TexelFormat::float32 : eight_bit;
    check(read_png(bytes, header, texture));
    if (eight_bit == TexelFormat::srgb8) make_linear(texture);
    return texture;
}

Texture decode_radiance(std::string_view bytes, const std::string& what, std::size_t room) {
    const auto check = [&](const std::string& fault) {
        if (!fault.empty()) refuse(what, "the image is damaged (" + fault + ")", "export it again");
    };
    RadianceHeader header;
    check(read_radiance_header(bytes, header));
    check_bytes(what, header.width, header.height, 3 * sizeof(float), room);
    constexpr std::uint64_t most_packed = 4096;
    check_plausible(what, header.width, header.height, std::uint64_t(header.width) * header.height * 3 / most_packed,
                    bytes.size());
    Texture texture;
    texture.width = header.width, texture.height = header.height, texture.channels = 3;
    texture.format = TexelFormat::float32;
    check(read_radiance_pixels(bytes, header, texture.floats));
    return texture;
}

/// The readers of a format of 8 bits a channel. Each returns what is wrong, or nothing.
struct ByteFormat {
    bool (*is_it)(std::string_view);
    std::string (*read_header)(std::string_view, ImageShape&);
    std::string (*read_pixels)(std::string_view, const ImageShape&, std::vector<std::uint8_t>&);
};
constexpr ByteFormat byte_formats[] = {{is_jpeg, read_jpeg_header, read_jpeg_pixels},
                                       {is_webp, read_webp_header, read_webp_pixels},
                                       {is_ktx2, read_ktx2_header, read_ktx2_pixels},
                                       {is_bmp, read_bmp_header, read_bmp_pixels}};
/// A TGA has no signature: what is no other format may be one.
constexpr ByteFormat tga_format = {is_tga, read_tga_header, read_tga_pixels};

Texture decode_bytes(const ByteFormat& format, std::string_view bytes, const std::string& what, TexelFormat eight_bit,
                     std::size_t room) {
    ImageShape shape;
    std::string fault = format.read_header(bytes, shape);
    if (!fault.empty()) refuse(what, fault, "export it again as PNG");
    check_bytes(what, shape.width, shape.height, shape.channels, room);
    check_plausible(what, shape.width, shape.height, shape.least_bytes, bytes.size());
    Texture texture;
    texture.width = shape.width, texture.height = shape.height, texture.channels = shape.channels;
    texture.format = eight_bit;
    fault = format.read_pixels(bytes, shape, texture.bytes);
    if (!fault.empty()) refuse(what, "the image is damaged (" + fault + ")", "export it again");
    return texture;
}

}  // namespace

Texture decode_texture(std::string_view bytes, const std::string& what, TexelFormat eight_bit, std::size_t room) {
    if (bytes.empty()) refuse(what, "it is empty", "export it again");
    if (is_pfm(bytes)) return decode_pfm(bytes, what, room);
    if (is_png(bytes)) return decode_png(bytes, what, eight_bit, room);
    if (is_exr(bytes)) return decode_exr(bytes, what, room);
    if (is_radiance(bytes)) return decode_radiance(bytes, what, room);
    for (const ByteFormat& format : byte_formats)
        if (format.is_it(bytes)) return decode_bytes(format, bytes, what, eight_bit, room);
    if (const OtherFormat other = other_format_of(bytes); !other.name.empty())
        refuse(what, "it is " + other.name + ", which claray does not read", other.remedy);
    if (!is_tga(bytes))
        refuse(what, "it is not a PNG, JPEG, WebP, BMP, TGA, HDR, PFM or EXR image", "convert it to one of these");
    return decode_bytes(tga_format, bytes, what, eight_bit, room);
}

Texture load_image(const fs::path& path, TexelFormat eight_bit) {
    if (eight_bit == TexelFormat::float32)
        throw Error(ErrorKind::usage, "load_image: bytes cannot be read as float32", "use srgb8 or linear8");
    Texture texture = decode_texture(read_file(path, "check the path"), "'" + path.string() + "'", eight_bit);
    texture.name = path.filename().string();
    return texture;
}

namespace {

/// Negative texels, which filters leave behind, and those that are not numbers become black; infinite ones as bright as
/// the brightest other.
void correct_radiance(Texture& texture, const std::string& what, Warnings& warnings) {
    float brightest = 0.f;
    std::size_t wrong = 0;
    for (const float value : texture.floats)
        if (std::isfinite(value)) brightest = std::max(brightest, value);
    for (float& value : texture.floats) {
        if (value >= 0.f && std::isfinite(value)) continue;
        value = value > 0.f ? brightest : 0.f, ++wrong;
    }
    if (wrong > 0)
        warnings.push_back(what + ": " + to_string(wrong) +
                           " values are negative or not finite: negative ones count "
                           "as 0, infinite ones as the largest other");
}

}  // namespace

Environment load_environment(const fs::path& path, Warnings& warnings) {
    Environment environment;
    std::error_code error;
    const auto add = [&](const fs::path& file) {
        const std::string bytes = read_file(file, "check the path"), what = "'" + file.string() + "'";
        Texture texture = decode_texture(bytes, what, TexelFormat::srgb8);
        texture.name = file.filename().string();
        correct_radiance(texture, what, warnings);
        if (is_exr(bytes) && is_exr_cube(bytes))
            environment.images = faces_of_exr_cube(texture);
        else
            environment.images.push_back(std::move(texture));
    };
    if (!fs::is_directory(path, error)) {
        add(path);
        return environment;
    }
    for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        fs::path found;
        for (const fs::directory_entry& entry : fs::directory_iterator(path, error))
            if (entry.path().stem() == face && entry.is_regular_file(error)) found = entry.path();
        if (found.empty())
            throw Error(ErrorKind::user,
                        "'" + path.string() + "' has no image '" + face + "' for this face of the cube",
                        "put px, nx, py, ny, pz and nz into the folder, or give one image in latitude and longitude");
        add(found);
    }
    return environment;
}

Environment load_environment(const fs::path& path) {
    Warnings warnings;
    return load_environment(path, warnings);
}

}  // namespace claray
