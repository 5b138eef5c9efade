// Images to files of all formats.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "claray/error.hpp"
#include "claray/io.hpp"
#include "host/base/color.hpp"
#include "host/base/file.hpp"
#include "host/io/image/exr.hpp"
#include "host/io/image/write/encode.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

/// Libraries count bytes with int.
constexpr unsigned most_pixels_a_side = 1u << 14, most_pixels_of_webp = (1u << 14) - 1;

std::string extensions() {
    std::string text;
    for (const ImageFormatTraits& traits : image_formats)
        text += (text.empty() ? "." : ", .") + std::string(traits.name);
    return text;
}

/// Throws what is wrong with the encoding of a file, but for the image's size.
ImageFormat checked_format(const fs::path& path, const ImageEncoding& encoding) {
    const auto refuse = [&](const std::string& why, const std::string& remedy) {
        throw Error(ErrorKind::usage, "cannot write '" + path.string() + "': " + why, remedy);
    };
    const auto format = encoding.format ? encoding.format : image_format_of(path);
    if (!format)
        refuse("unknown image format '" + path.extension().string() + "'", "use one of the extensions " + extensions());
    if (encoding.png_bits != 8 && encoding.png_bits != 16)
        refuse("a PNG has no " + std::to_string(encoding.png_bits) + " bits a channel", "choose 8 or 16");
    if (encoding.quality < 1 || encoding.quality > 100)
        refuse("its quality is " + std::to_string(encoding.quality), "choose 1 to 100");
    if (encoding.lossless && format == ImageFormat::jpeg)
        refuse("a JPEG loses some of each image", "write a .webp or a .png");
    if (format == ImageFormat::exr) require_exr(path.string());
    if (format == ImageFormat::webp) require_webp(path.string());
    return *format;
}

void check_size(const fs::path& path, unsigned width, unsigned height, std::size_t values, unsigned limit) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    if (width == 0 || height == 0 || width > limit || height > limit)
        throw Error(ErrorKind::usage, "cannot write '" + path.string() + "': its size is " + size,
                    "use 1 to " + std::to_string(limit) + " pixels per side");
    if (values != std::size_t(width) * height)
        throw Error(ErrorKind::usage,
                    "cannot write '" + path.string() + "': " + std::to_string(values) + " pixels for " + size,
                    "pass width * height pixels");
}

void write_encoded(const fs::path& path, const std::string& bytes) {
    if (bytes.empty())
        throw Error(ErrorKind::user, "cannot encode '" + path.string() + "': out of memory", "use a smaller image");
    write_file(path, bytes);
}

/// The numbers of a picture: 8 or 16 bits each, red, green and blue of each pixel.
template <class Number>
std::vector<Number> picture_of(const Image& image, float exposure, ToneMap tone_map) {
    const float gain = std::exp2(exposure);
    std::vector<Number> numbers;
    numbers.reserve(3 * image.pixels.size());
    for (const glm::vec3& pixel : image.pixels)
        for (int k = 0; k < 3; ++k) {
            const double encoded = srgb_curve(tone_mapped(gain * pixel[k], tone_map));
            numbers.push_back(Number(std::lround(encoded * std::numeric_limits<Number>::max())));
        }
    return numbers;
}

std::string png16_bytes(const Image& image, float exposure, ToneMap tone_map) {
    const auto words = picture_of<std::uint16_t>(image, exposure, tone_map);
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(words.data());
    return encode_png(image.width, image.height, 3, {bytes, words.size() * sizeof words[0]}, 16);
}

/// Of the formats of 8 bits.
std::string picture_bytes(ImageFormat format, const Image& image, float exposure, ToneMap tone_map,
                          const ImageEncoding& encoding) {
    const auto bytes = picture_of<std::uint8_t>(image, exposure, tone_map);
    switch (format) {
        case ImageFormat::jpeg: return encode_jpeg(image.width, image.height, 3, bytes, encoding.quality);
        case ImageFormat::webp:
            return encode_webp(image.width, image.height, bytes, encoding.quality, encoding.lossless);
        default: return encode_png(image.width, image.height, 3, bytes);
    }
}

std::string hdr_bytes(const Image& image) {
    std::vector<float> values;
    values.reserve(3 * image.pixels.size());
    for (const glm::vec3& pixel : image.pixels)
        for (int k = 0; k < 3; ++k) {
            // RGBE knows no sign, NaN or infinity, and its exponent ends below 2^127.
            const float value = pixel[k];
            values.push_back(value > 0.f ? std::min(value, 1e38f) : 0.f);
        }
    return encode_hdr(image.width, image.height, values);
}

/// Portable float map (Debevec): rows from the bottom up; a negative scale says little endian.
std::string pfm_bytes(unsigned width, unsigned height, unsigned channels, const float* values) {
    const bool little = std::endian::native == std::endian::little;
    const std::string header = std::string(channels == 3 ? "PF\n" : "Pf\n") + std::to_string(width) + " " +
                               std::to_string(height) + "\n" + (little ? "-1.0\n" : "1.0\n");
    const std::size_t row = std::size_t(width) * channels;
    std::string bytes(header.size() + row * height * sizeof(float), '\0');
    char* out = std::copy(header.begin(), header.end(), bytes.data());
    for (unsigned y = height; y-- > 0; out += row * sizeof(float))
        std::memcpy(out, values + y * row, row * sizeof(float));
    return bytes;
}

}  // namespace

std::optional<ImageFormat> image_format_of(const fs::path& path) {
    const std::string extension = lower_case(path.extension().string());
    for (const ImageFormatTraits& traits : image_formats)
        if (extension == "." + std::string(traits.name)) return traits.format;
    return {};
}

std::string encode_image(const fs::path& name, const Image& image, float exposure, ToneMap tone_map,
                         const ImageEncoding& encoding) {
    const ImageFormat format = checked_format(name, encoding);
    check_size(name, image.width, image.height, image.pixels.size(),
               format == ImageFormat::webp ? most_pixels_of_webp : most_pixels_a_side);
    switch (format) {
        case ImageFormat::hdr: return hdr_bytes(image);
        case ImageFormat::pfm: return pfm_bytes(image.width, image.height, 3, &image.pixels[0].x);
        case ImageFormat::exr: {
            ImageLayer layer;
            layer.values.assign(&image.pixels[0].x, &image.pixels[0].x + 3 * image.pixels.size());
            return encode_exr(image.width, image.height, {layer}, {});
        }
        case ImageFormat::png:
            if (encoding.png_bits == 16) return png16_bytes(image, exposure, tone_map);
            [[fallthrough]];
        default: return picture_bytes(format, image, exposure, tone_map, encoding);
    }
}

void write_image(const fs::path& path, const Image& image, float exposure, ToneMap tone_map,
                 const ImageEncoding& encoding) {
    write_encoded(path, encode_image(path, image, exposure, tone_map, encoding));
}

void write_exr(const fs::path& path, unsigned width, unsigned height, const std::vector<ImageLayer>& layers,
               const ImageAttributes& attributes) {
    require_exr(path.string());
    for (const ImageLayer& layer : layers) {
        const std::size_t values = layer.numbers.empty() ? layer.values.size() : layer.numbers.size(),
                          n = layer.channels.size();
        check_size(path, width, height, n == 0 || values % n != 0 ? 0 : values / n, most_pixels_a_side);
    }
    write_encoded(path, encode_exr(width, height, layers, attributes));
}

void write_pfm(const fs::path& path, unsigned width, unsigned height, const std::vector<float>& values) {
    check_size(path, width, height, values.size(), most_pixels_a_side);
    write_file(path, pfm_bytes(width, height, 1, values.data()));
}

void write_texture(const fs::path& path, const Texture& texture) {
    const bool real = texture.format == TexelFormat::float32;
    if (checked_format(path, {}) != (real ? ImageFormat::pfm : ImageFormat::png))
        throw Error(
            ErrorKind::usage,
            "cannot write '" + path.string() + "': the number of texels does not match the texture's size and format",
            "use .png for bytes and .pfm for floats");
    const unsigned n = texture.channels;
    if (n < 1 || n > 4 || (real && n != 1 && n != 3))
        throw Error(ErrorKind::usage, "cannot write '" + path.string() + "': it has " + std::to_string(n) + " channels",
                    "PNG supports 1 to 4 channels, PFM 1 or 3");
    const std::size_t values = real ? texture.floats.size() : texture.bytes.size();
    check_size(path, texture.width, texture.height, values % n ? 0 : values / n, most_pixels_a_side);
    if (real) return write_file(path, pfm_bytes(texture.width, texture.height, n, texture.floats.data()));
    write_encoded(path, encode_png(texture.width, texture.height, n, texture.bytes));
}

void check_writable(const fs::path& path, const ImageEncoding& encoding) {
    static_cast<void>(checked_format(path, encoding));
    check_file_writable(path);
}

}  // namespace claray
