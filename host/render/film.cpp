#include "host/render/film.hpp"

#include <cmath>

namespace claray {
namespace {
constexpr std::uint32_t noise_items = 4096;
}

Film::Kernels::Kernels(const Device& device)
    : accumulate(load_kernel(device, "render/accumulate_film.cl", "accumulate_film")),
      resolve(load_kernel(device, "render/resolve_film.cl", "resolve_film")),
      noise(load_kernel(device, "render/resolve_film.cl", "measure_noise")) {}

Film::Film(const Device& device, std::uint32_t pixels)
    : device_(device), pixels_(device, pixels), sums_(device, noise_items), kernels_(device) {
    pixels_.fill(0);
}

void Film::accumulate(const Batch& batch, const Buffer<float>& radiance) {
    kernels_.accumulate.run({batch.pixels, 64}, batch, radiance, pixels_);
}

std::vector<glm::vec3> Film::resolve() const {
    const auto count = std::uint32_t(pixels_.size());
    const Buffer<float> image(device_, 3 * pixels_.size());
    kernels_.resolve.run({count, 64}, pixels_, count, image);
    const std::vector<float> values = image.read();
    std::vector<glm::vec3> result(count);
    for (std::size_t i = 0; i < count; ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return result;
}

Film::Noise Film::noise() const {
    kernels_.noise.run({noise_items, 64}, pixels_, std::uint32_t(pixels_.size()), noise_items, sums_);
    double variance = 0, luminance = 0, pixels = 0;
    Noise noise;
    for (const NoiseSums& sums : sums_.read()) {
        variance += sums.variance;
        luminance += sums.luminance;
        pixels += sums.pixels;
        noise.dropped += sums.dropped;
    }
    if (luminance > 0) noise.relative = std::sqrt(variance / pixels) / (luminance / pixels);
    return noise;
}

}  // namespace claray
