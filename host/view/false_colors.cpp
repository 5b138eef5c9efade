#include "host/view/false_colors.hpp"

#include <algorithm>
#include <cmath>

namespace claray::view {
namespace {

constexpr int noise_radius = 2;  // of the square of pixels over which the error map takes the mean

}  // namespace

std::vector<std::uint8_t> encoded(const Image& image) {
    std::vector<std::uint8_t> bytes;
    for (const glm::vec3& c : image.pixels)
        bytes.insert(bytes.end(), {srgb_from_linear(c.x), srgb_from_linear(c.y), srgb_from_linear(c.z), 255});
    return bytes;
}

/// The root of the mean over the pixels nearby: the variance that two halves of a pixel's samples tell is as noisy as
/// its square.
Image error_map(const std::vector<float>& variances, int width, int height) {
    std::vector<float> errors;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            int count = 0;
            for (int v = std::max(y - noise_radius, 0); v <= std::min(y + noise_radius, height - 1); ++v)
                for (int u = std::max(x - noise_radius, 0); u <= std::min(x + noise_radius, width - 1); ++u, ++count)
                    sum += double(variances[std::size_t(v) * std::size_t(width) + std::size_t(u)]);
            errors.push_back(float(std::sqrt(sum / count)));
        }
    return false_color(unsigned(width), unsigned(height), errors);
}

Image image_of(const Aovs& aovs, const std::string& shows, unsigned width, unsigned height) {
    if (shows == "depth") return false_color(width, height, aovs.depth);
    if (shows == "primitive") return identifier_color(width, height, aovs.primitive);
    if (shows == "heat") return false_color(width, height, {aovs.visits.begin(), aovs.visits.end()});
    Image image{width, height, aovs.albedo};
    if (shows == "normal")
        for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.5f * (aovs.normal[i] + 1.f);
    return image;
}

}  // namespace claray::view
