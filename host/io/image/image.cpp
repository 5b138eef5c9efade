// Images to PNG, Radiance HDR, PFM and OpenEXR.
#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>

#include "claray/error.hpp"
#include "claray/io.hpp"
#include "host/base/file.hpp"
#include "host/io/image/exr.hpp"
#include "host/io/image/stb_image_write.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

enum class ImageFormat { png, hdr, pfm, exr };

/// stb_image_write counts bytes with int.
constexpr unsigned most_pixels_a_side = 1u << 14;

ImageFormat image_format_of(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (extension == ".png") return ImageFormat::png;
    if (extension == ".hdr") return ImageFormat::hdr;
    if (extension == ".pfm") return ImageFormat::pfm;
    if (extension == ".exr") return ImageFormat::exr;
    throw Error(ErrorKind::usage, "cannot write '" + path.string() + "': unknown image format '" + extension + "'",
                "use the extension .png, .hdr, .pfm or .exr");
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

std::string png_bytes(const Image& image, float exposure, ToneMap tone_map) {
    const float gain = std::exp2(exposure);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * image.pixels.size());
    for (const glm::vec3& pixel : image.pixels)
        for (int k = 0; k < 3; ++k) {
            const float value = gain * pixel[k];
            bytes.push_back(srgb_from_linear(tone_mapped(value, tone_map)));
        }
    return encode_png(image.width, image.height, 3, bytes);
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

void write_image(const fs::path& path, const Image& image, float exposure, ToneMap tone_map) {
    const ImageFormat format = image_format_of(path);
    check_size(path, image.width, image.height, image.pixels.size(), most_pixels_a_side);
    switch (format) {
        case ImageFormat::png: return write_encoded(path, png_bytes(image, exposure, tone_map));
        case ImageFormat::hdr: return write_encoded(path, hdr_bytes(image));
        case ImageFormat::exr: {
            ImageLayer layer;
            layer.values.assign(&image.pixels[0].x, &image.pixels[0].x + 3 * image.pixels.size());
            return write_exr(path, image.width, image.height, {layer});
        }
        case ImageFormat::pfm: return write_file(path, pfm_bytes(image.width, image.height, 3, &image.pixels[0].x));
    }
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
    if (image_format_of(path) != (real ? ImageFormat::pfm : ImageFormat::png))
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

void check_writable(const fs::path& path) {
    if (image_format_of(path) == ImageFormat::exr) require_exr(path.string());
    check_file_writable(path);
}

}  // namespace claray
