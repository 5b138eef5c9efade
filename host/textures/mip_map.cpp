#include "host/textures/mip_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace claray {
namespace {

/// Linear values, texel by texel.
struct Level {
    unsigned width, height, channels;
    std::vector<float> values;
};

const std::array<float, 256>& srgb_table() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (int i = 0; i < 256; ++i) {
            const double c = i / 255.0;
            values[std::size_t(i)] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
        }
        return values;
    }();
    return table;
}

bool is_color(const Texture& texture, unsigned channel) {
    return texture.format == TexelFormat::srgb8 && (texture.channels % 2 == 1 || channel + 1 < texture.channels);
}

/// The texels (up to three) of a row of `size` that texel i of a row of half the length covers, and their weights.
struct Taps {
    unsigned first, count;
    double weight[3];
};

Taps taps_of(unsigned i, unsigned size) {
    if (size == 1) return {0, 1, {1}};
    if (size % 2 == 0) return {2 * i, 2, {0.5, 0.5}};
    const double half = size / 2, whole = size;
    return {2 * i, 3, {(half - i) / whole, half / whole, (i + 1) / whole}};
}

/// `value(x, y, channel)` of a level of this size.
template <class Value>
Level halved(unsigned width, unsigned height, unsigned channels, const Value& value) {
    Level result{std::max(1u, width / 2), std::max(1u, height / 2), channels, {}};
    result.values.reserve(std::size_t(result.width) * result.height * channels);
    for (unsigned y = 0; y < result.height; ++y) {
        const Taps rows = taps_of(y, height);
        for (unsigned x = 0; x < result.width; ++x) {
            const Taps columns = taps_of(x, width);
            for (unsigned c = 0; c < channels; ++c) {
                double sum = 0;
                for (unsigned j = 0; j < rows.count; ++j)
                    for (unsigned i = 0; i < columns.count; ++i)
                        sum += rows.weight[j] * columns.weight[i] * double(value(columns.first + i, rows.first + j, c));
                result.values.push_back(float(sum));
            }
        }
    }
    return result;
}

std::uint8_t byte_of(float value) { return std::uint8_t(std::lround(std::clamp(value, 0.f, 1.f) * 255.f)); }

/// The bytes of the values, with zeros up to a whole word.
template <class T>
std::vector<std::uint32_t> words_of(const std::vector<T>& values) {
    std::vector<std::uint32_t> words((values.size() * sizeof(T) + 3) / 4);
    std::memcpy(words.data(), values.data(), values.size() * sizeof(T));
    return words;
}

std::vector<std::uint32_t> packed(const Texture& texture, const Level& level) {
    if (texture.format == TexelFormat::float32) return words_of(level.values);
    const unsigned channels = level.channels, stride = channels == 3 ? 4 : channels;
    const std::size_t texels = level.values.size() / channels;
    std::vector<std::uint8_t> bytes((texels * stride + 3) / 4 * 4, 255);
    for (std::size_t i = 0; i < texels; ++i)
        for (unsigned c = 0; c < channels; ++c) {
            const float value = level.values[i * channels + c];
            bytes[i * stride + c] = is_color(texture, c) ? encode_srgb(value) : byte_of(value);
        }
    return words_of(bytes);
}

/// The image itself, untouched.
std::vector<std::uint32_t> packed_image(const Texture& texture) {
    if (texture.format == TexelFormat::float32) return words_of(texture.floats);
    if (texture.channels != 3) return words_of(texture.bytes);
    const std::size_t texels = std::size_t(texture.width) * texture.height;
    std::vector<std::uint32_t> words;
    words.reserve(texels);
    for (std::size_t i = 0; i < texels; ++i)
        words.push_back(texture.bytes[3 * i] | std::uint32_t(texture.bytes[3 * i + 1]) << 8 |
                        std::uint32_t(texture.bytes[3 * i + 2]) << 16 | 0xff000000u);
    return words;
}

}  // namespace

float decode_srgb(std::uint8_t value) { return srgb_table()[value]; }

float linear_value(const Texture& texture, std::size_t texel, unsigned channel) {
    const std::size_t at = texel * texture.channels + channel;
    if (texture.format == TexelFormat::float32) return texture.floats[at];
    const std::uint8_t byte = texture.bytes[at];
    return is_color(texture, channel) ? decode_srgb(byte) : float(byte) / 255.f;
}

std::uint8_t encode_srgb(float linear) {
    const double c = std::clamp(double(linear), 0.0, 1.0);
    const double curved = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    return std::uint8_t(std::lround(curved * 255));
}

unsigned mip_levels(unsigned width, unsigned height) { return unsigned(std::bit_width(std::max(width, height))); }

std::vector<std::vector<std::uint32_t>> packed_levels(const Texture& texture, unsigned levels) {
    std::vector<std::vector<std::uint32_t>> result = {packed_image(texture)};
    Level level{texture.width, texture.height, texture.channels, {}};
    while (result.size() < levels) {
        const unsigned width = level.width;
        if (result.size() == 1) {  // converted from bytes directly: as floats the image would be four times as large
            level = halved(width, level.height, level.channels, [&](unsigned x, unsigned y, unsigned c) {
                return linear_value(texture, std::size_t(y) * width + x, c);
            });
        } else {
            const Level above = std::move(level);
            level = halved(width, above.height, above.channels, [&](unsigned x, unsigned y, unsigned c) {
                return above.values[(std::size_t(y) * width + x) * above.channels + c];
            });
        }
        result.push_back(packed(texture, level));
    }
    return result;
}

}  // namespace claray
