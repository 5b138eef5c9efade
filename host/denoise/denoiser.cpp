#include "host/denoise/denoiser.hpp"

namespace claray {
namespace {

constexpr std::uint32_t passes = 5;  // which reach 62 pixels

}  // namespace

Denoiser::Denoiser(const Device& device, std::uint32_t width, std::uint32_t height)
    : width_(width),
      height_(height),
      demodulate_(load_kernel(device, "denoise/demodulate.cl", "demodulate")),
      estimate_(load_kernel(device, "denoise/estimate_variance.cl", "estimate_variance")),
      filter_(load_kernel(device, "denoise/filter_light.cl", "filter_light")),
      modulate_(load_kernel(device, "denoise/modulate.cl", "modulate")) {
    const std::size_t pixels = std::size_t(width) * height;
    for (Buffer<Float4>* buffer : {&raw_, &noisy_, &filtered_[0], &filtered_[1], &surfaces_})
        *buffer = Buffer<Float4>(device, pixels);
    slopes_ = Buffer<Float2>(device, pixels);
    weights_ = Buffer<float>(device, pixels);
    image_ = Buffer<float>(device, 3 * pixels);
}

const Buffer<float>& Denoiser::denoise(const Buffer<FilmPixel>& film, const Buffer<Guide>& guides, bool single) {
    const Range range{std::size_t(width_) * height_, 64};
    FilterStep step{width_, height_, 1, 0};
    demodulate_.run(range, step, film, guides, arg("light", raw_), arg("surfaces", surfaces_), arg("weights", weights_));
    estimate_.run(range, step, std::uint32_t(single), arg("light", raw_), arg("surfaces", surfaces_), arg("weights", weights_), slopes_,
                  arg("result", noisy_));
    const Buffer<Float4>* from = &noisy_;
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        const Buffer<Float4>& to = filtered_[pass % 2];
        step.spacing = 1u << pass;
        filter_.run(range, step, arg("light", *from), arg("surfaces", surfaces_), arg("weights", weights_), slopes_, arg("result", to));
        from = &to;
    }
    modulate_.run(range, step, std::uint32_t(!single), arg("noisy", raw_), arg("filtered", *from), guides, image_);
    return image_;
}

}  // namespace claray
