#include "host/denoise/denoiser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace claray {
namespace {

constexpr std::uint32_t passes = 5;        // which reach 62 pixels
constexpr std::uint32_t most_frames = 32;  // of a history; longer ones gain little and follow light more slowly

/// The variances of two halves of few samples are too small more often than too large: they count more than once. Those
/// of many samples are rather too large, since the halves of a Sobol sequence complete each other (docs/accuracy.md).
float doubt_of(std::uint32_t spp) { return CLARAY_MOST_DOUBT / (1 + float(spp) * float(spp) / 1024); }

}  // namespace

Denoiser::Denoiser(const Device& device, std::uint32_t width, std::uint32_t height)
    : width_(width),
      height_(height),
      cpu_(device.info().type == DeviceType::cpu),
      demodulate_(load_kernel(device, "denoise/demodulate.cl", "demodulate")),
      reject_(load_kernel(device, "denoise/reject_outliers.cl", "reject_outliers")),
      estimate_(load_kernel(device, "denoise/estimate_variance.cl", "estimate_variance")),
      filter_(load_kernel(device, "denoise/filter_light.cl", "filter_light")),
      measure_(load_kernel(device, "denoise/modulate.cl", "measure_changes")),
      modulate_(load_kernel(device, "denoise/modulate.cl", "modulate")) {
    const std::size_t pixels = std::size_t(width) * height;
    for (Buffer<Float4>* buffer : {&raw_, &noisy_, &filtered_[0], &filtered_[1], &surfaces_})
        *buffer = Buffer<Float4>(device, pixels);
    slopes_ = Buffer<Float2>(device, pixels), gloss_ = Buffer<Float2>(device, pixels);
    weights_ = Buffer<float>(device, pixels), kept_ = Buffer<float>(device, pixels);
    image_ = Buffer<float>(device, 3 * pixels);
}

Range Denoiser::range_of_runs() const { return cpu_ ? Range{std::size_t((width_ + 15) / 16) * height_, 4} : range(); }

const Buffer<float>& Denoiser::denoise(const Buffer<FilmPixel>& film, const Buffer<Guide>& guides, std::uint32_t spp) {
    prepare(film, guides, spp);
    return filter(noisy_, raw_, guides, spp);
}

std::uint64_t Denoiser::bytes() const {
    return raw_.bytes() + noisy_.bytes() + filtered_[0].bytes() + filtered_[1].bytes() + surfaces_.bytes() +
           slopes_.bytes() + gloss_.bytes() + weights_.bytes() + kept_.bytes() + image_.bytes();
}

void Denoiser::prepare(const Buffer<FilmPixel>& film, const Buffer<Guide>& guides, std::uint32_t spp) {
    const Buffer<Float4>&sampled = noisy_, &rejected = filtered_[0];  // until those have their own contents
    demodulate_.run(range(), step(), film, guides, arg("light", sampled), arg("surfaces", surfaces_),
                    arg("weights", weights_), gloss_);
    reject_.run(range_of_runs(), step(), std::uint32_t(spp < 2), arg("light", sampled), arg("weights", weights_),
                arg("result", raw_), arg("rejected", rejected));
    estimate_.run(range_of_runs(), step(), std::uint32_t(spp < 2), arg("light", raw_), arg("rejected", rejected),
                  arg("surfaces", surfaces_), arg("weights", weights_), arg("gloss", gloss_), guides,
                  arg("slopes", slopes_), arg("result", noisy_));
}

const Buffer<float>& Denoiser::filter(const Buffer<Float4>& light, const Buffer<Float4>& noisy,
                                      const Buffer<Guide>& guides, std::uint32_t spp) {
    const Buffer<Float4>* from = &light;
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        const Buffer<Float4>& to = filtered_[pass % 2];
        filter_.run(range_of_runs(), step(1u << pass), arg("light", *from), arg("surfaces", surfaces_),
                    arg("weights", weights_), slopes_, arg("result", to), arg("kept", kept_));
        from = &to;
    }
    const Buffer<Float4>& changes = filtered_[passes % 2];  // which the last pass has read
    const float doubt = doubt_of(spp);
    if (spp >= 2)
        measure_.run(range(), step(), doubt, arg("noisy", noisy), arg("filtered", *from), arg("kept", kept_), guides,
                     arg("changes", changes));
    modulate_.run(range(), step(), std::uint32_t(spp < 2), doubt, arg("noisy", noisy), arg("filtered", *from),
                  arg("changes", changes), guides, arg("image", image_));
    return image_;
}

FrameDenoiser::FrameDenoiser(const Device& device, std::uint32_t width, std::uint32_t height)
    : Denoiser(device, width, height),
      reproject_(load_kernel(device, "denoise/reproject.cl", "reproject")),
      blend_(load_kernel(device, "denoise/reproject.cl", "blend_history")) {
    const std::size_t pixels = std::size_t(width) * height;
    for (Buffer<Float4>* buffer : {&old_light_, &old_surfaces_, &history_, &blended_})
        *buffer = Buffer<Float4>(device, pixels);
    for (Buffer<float>* buffer : {&old_ages_, &ages_, &history_ages_}) *buffer = Buffer<float>(device, pixels);
}

std::uint64_t FrameDenoiser::bytes() const {
    return Denoiser::bytes() + old_light_.bytes() + old_surfaces_.bytes() + history_.bytes() + blended_.bytes() +
           old_ages_.bytes() + ages_.bytes() + history_ages_.bytes();
}

void FrameDenoiser::keep_frame() {
    std::swap(old_light_, blended_), std::swap(old_ages_, ages_), std::swap(old_surfaces_, surfaces_);
    old_camera_ = camera_, old_spp_ = spp_;
}

const Buffer<float>& FrameDenoiser::denoise(const CameraData& camera, const Buffer<FilmPixel>& film,
                                            const Buffer<Guide>& guides, std::uint32_t spp, bool continues) {
    if (!continues || films_ == 0) {
        films_ > 0 ? keep_frame() : old_ages_.fill(0);
        films_ = std::min<std::uint32_t>(films_ + 1, 2);
    }
    camera_ = camera, spp_ = spp;
    prepare(film, guides, spp);
    const CameraPair cameras{camera, films_ < 2 ? camera : old_camera_};
    reproject_.run(range(), step(), cameras, arg("surfaces", surfaces_), arg("light", noisy_),
                   arg("old_surfaces", old_surfaces_), arg("old_light", old_light_), arg("old_ages", old_ages_),
                   arg("result", history_), arg("ages", history_ages_));
    const auto most = float(most_frames - 1) * float(old_spp_);
    blend_.run(range(), step(), float(spp), most, arg("surfaces", surfaces_), slopes_, arg("fresh", noisy_),
               arg("old", history_), arg("old_ages", history_ages_), arg("result", blended_), arg("ages", ages_));
    return filter(blended_, blended_, guides, std::max(spp, 2u));
}

}  // namespace claray
