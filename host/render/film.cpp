#include "host/render/film.hpp"

#include <algorithm>
#include <cmath>

namespace claray {
namespace {
constexpr std::uint32_t most_items = 4096;  // that sum up pixels
}

Film::Kernels::Kernels(const Device& device)
    : accumulate(load_kernel(device, "render/accumulate_film.cl", "accumulate_film")),
      resolve(load_kernel(device, "render/resolve_film.cl", "resolve_film")),
      noise(load_kernel(device, "render/resolve_film.cl", "measure_noise")) {}

Film::Film(const Device& device, std::uint32_t pixels, std::uint32_t films)
    : device_(device),
      count_(pixels),
      films_(films),
      pixels_(device, std::size_t(pixels) * films),
      sums_(device, std::min(pixels, most_items)),
      kernels_(device) {
    clear();
    if (films < 2) return;
    error_sums_ = Buffer<ErrorSums>(device, std::min(pixels, most_items));
    accumulate_odd_ = load_kernel(device, "render/accumulate_film.cl", "accumulate_odd");
    measure_error_ = load_kernel(device, "render/measure_error.cl", "measure_error");
}

void Film::accumulate(const Batch& batch, const Buffer<float>& radiance) {
    kernels_.accumulate.run({batch.pixels, 64}, batch, radiance, pixels_);
    if (films_ < 2) return;
    Batch odd = batch;
    odd.first_pixel += count_;
    accumulate_odd_.run({batch.pixels, 64}, odd, radiance, pixels_);
}

std::vector<glm::vec3> Film::resolve() const {
    const Buffer<float> image(device_, 3 * std::size_t(count_));
    kernels_.resolve.run({count_, 64}, pixels_, count_, image);
    const std::vector<float> values = image.read();
    std::vector<glm::vec3> result(count_);
    for (std::size_t i = 0; i < count_; ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return result;
}

Film::Noise Film::noise() const {
    const auto items = std::uint32_t(sums_.size());
    kernels_.noise.run({items, 64}, pixels_, count_, items, sums_);
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

Film::ErrorTotals Film::error_totals(float scale) const {
    const auto items = std::uint32_t(error_sums_.size());
    measure_error_.run({items, 64}, pixels_, count_, scale, items, error_sums_);
    ErrorTotals total;
    for (const ErrorSums& sums : error_sums_.read()) {
        total.variance += sums.variance;
        total.squares += sums.squares;
        total.value += sums.value;
        total.pixels += sums.pixels;
    }
    return total;
}

/// With v the variance of a pixel as its two halves tell it, of true value s^2: v is s^2 times chi^2 of one degree of
/// freedom, and so is the squared error of the pixel, independent of it. Sums of these over the pixels are about chi^2
/// of (sum s^2)^2 / sum s^4 degrees (Welch and Satterthwaite), as many as there are pixels that share the error: so the
/// image's squared error over its estimate is distributed as F. Expectations: v^2 has 3 s^4, and for n equal pixels
/// (sum v)^2 / sum v^2 has about (n + 2) / 3. (Channels count as one, which makes the degrees fewer than they are.)
Film::Error Film::error(ErrorLooks& looks, std::uint32_t spp) const {
    ErrorTotals total = error_totals(1);
    if (!(total.value > 0)) return {};
    const auto scale = float(std::exp2(-std::round(std::log2(total.value / (3 * total.pixels)))));
    if (scale < 0x1p-10f || scale > 0x1p10f) total = error_totals(scale);
    const double mean = total.value / (3 * total.pixels);
    const double estimate = std::sqrt(total.variance / (3 * total.pixels)) / mean;
    if (!(total.squares > 0)) return {estimate, estimate};
    looks.add(estimate * estimate, 3 * total.variance * total.variance / total.squares - 2, spp);
    return {estimate, std::max(estimate, looks.bound())};
}

}  // namespace claray
