// Height fields to normal maps.
#include <algorithm>
#include <cmath>

#include "claray/error.hpp"
#include "claray/io.hpp"
#include "host/base/color.hpp"

namespace claray {
namespace {

/// The heights of an image (its first channel; bytes of sRGB are decoded) with wrapped coordinates.
class Heights {
public:
    explicit Heights(const Texture& image) : image_(image) {
        const std::size_t count = std::size_t(image.width) * image.height, step = image.channels;
        const bool real = image.format == TexelFormat::float32;
        if (count == 0 || (real ? image.floats.size() : image.bytes.size()) != count * step)
            throw Error(ErrorKind::user, "height field '" + image.name + "': its size is not that of its texels",
                        "give width * height * channels numbers");
        for (std::size_t i = 0; i < count; ++i) {
            const double byte = real ? 0 : image.bytes[i * step] / 255.0;
            values_.push_back(real                                 ? double(image.floats[i * step])
                              : image.format == TexelFormat::srgb8 ? decode_srgb(byte)
                                                                   : byte);
        }
    }

    [[nodiscard]] double at(int x, int y) const {
        return values_[wrapped(y, int(image_.height), image_.wrap_v) * image_.width +
                       wrapped(x, int(image_.width), image_.wrap_u)];
    }

private:
    /// Of a neighbour of the image; mirrored images continue with the same texel.
    static std::size_t wrapped(int i, int size, Wrap wrap) {
        return std::size_t(wrap == Wrap::repeat ? (i + size) % size : std::clamp(i, 0, size - 1));
    }

    const Texture& image_;
    std::vector<double> values_;
};

}  // namespace

Texture normal_map_of(const Texture& heights, float strength) {
    const Heights h(heights);
    Texture map;
    map.name = heights.name, map.width = heights.width, map.height = heights.height;
    map.channels = 3, map.format = TexelFormat::linear8;
    map.wrap_u = heights.wrap_u, map.wrap_v = heights.wrap_v;
    for (int y = 0; y < int(map.height); ++y)
        for (int x = 0; x < int(map.width); ++x) {
            const double by_x = 0.5 * double(strength) * (h.at(x + 1, y) - h.at(x - 1, y));
            const double upwards = 0.5 * double(strength) * (h.at(x, y - 1) - h.at(x, y + 1));
            const glm::dvec3 normal = glm::normalize(glm::dvec3(-by_x, -upwards, 1));
            for (int k = 0; k < 3; ++k) map.bytes.push_back(std::uint8_t(std::lround(255 * (0.5 + 0.5 * normal[k]))));
        }
    return map;
}

}  // namespace claray
