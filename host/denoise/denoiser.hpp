// Removes noise from a film by filtering light on the device, guided by what the pixels' camera rays meet first.
#pragma once

#include "claray/program.hpp"
#include "claray/shared/denoise.h"
#include "claray/shared/path.h"

namespace claray {

/// Vectors of OpenCL.
struct Float2 {
    float x, y;
};
struct Float4 {
    float x, y, z, w;
};
constexpr const char* device_type_name(const Float2*) { return "float2"; }
constexpr const char* device_type_name(const Float4*) { return "float4"; }

class Denoiser {
public:
    Denoiser(const Device& device, std::uint32_t width, std::uint32_t height);

    /// Returns the linear radiance, 3 floats per pixel; valid until the next call. `spp`: samples per pixel of
    /// the film. Asynchronous.
    [[nodiscard]] const Buffer<float>& denoise(const Buffer<FilmPixel>& film, const Buffer<Guide>& guides,
                                               std::uint32_t spp);
    /// Of the device.
    [[nodiscard]] std::uint64_t bytes() const;

protected:
    /// Writes `raw_`, `noisy_`, `surfaces_`, `slopes_`.
    void prepare(const Buffer<FilmPixel>& film, const Buffer<Guide>& guides, std::uint32_t spp);
    /// Filters `light`. `noisy` is mixed in where its variance is small, from two samples per pixel on.
    [[nodiscard]] const Buffer<float>& filter(const Buffer<Float4>& light, const Buffer<Float4>& noisy,
                                              const Buffer<Guide>& guides, std::uint32_t spp);
    [[nodiscard]] Range range() const { return {std::size_t(width_) * height_, 64}; }
    /// Of kernels whose work-items have sixteen pixels of a row on CPUs.
    [[nodiscard]] Range range_of_runs() const;
    [[nodiscard]] FilterStep step(std::uint32_t spacing = 1) const { return {width_, height_, spacing}; }

    std::uint32_t width_, height_;
    bool cpu_;
    Kernel demodulate_, reject_, estimate_, filter_, measure_, modulate_;
    Buffer<Float4> raw_, noisy_, filtered_[2], surfaces_;
    Buffer<Float2> slopes_, gloss_;
    Buffer<float> weights_, kept_, image_;
};

/// For frames: also uses the light of the frames before, while the camera moves. Buffers are kept from frame to frame.
class FrameDenoiser : private Denoiser {
public:
    FrameDenoiser(const Device& device, std::uint32_t width, std::uint32_t height);

    /// As Denoiser::denoise; `camera` and `spp` are those of this frame. `continues`: the film is that of the last
    /// call with more samples, so that this frame replaces that one.
    [[nodiscard]] const Buffer<float>& denoise(const CameraData& camera, const Buffer<FilmPixel>& film,
                                               const Buffer<Guide>& guides, std::uint32_t spp, bool continues = false);
    /// Forgets the frames before, for example if materials or lights were replaced.
    void forget() { films_ = 0; }
    [[nodiscard]] std::uint64_t bytes() const;

private:
    /// Makes the last frame the one before.
    void keep_frame();

    Kernel reproject_, blend_;
    CameraData camera_{}, old_camera_{};
    std::uint32_t spp_ = 0, old_spp_ = 0;
    std::uint32_t films_ = 0;  // up to two: this one, and one before
    Buffer<Float4> old_light_, old_surfaces_, history_, blended_;
    Buffer<float> old_ages_, ages_, history_ages_;
};

}  // namespace claray
