// Removes noise from a film by filtering light on the device, guided by what the pixels' camera rays meet first.
#pragma once

#include "claray/program.hpp"
#include "claray/shared/denoise.h"
#include "claray/shared/path.h"

namespace claray {

class Denoiser {
public:
    Denoiser(const Device& device, std::uint32_t width, std::uint32_t height);

    /// Returns the linear radiance, 3 floats per pixel; valid until the next call. `single`: no pixel has two samples.
    /// Asynchronous.
    [[nodiscard]] const Buffer<float>& denoise(const Buffer<FilmPixel>& film, const Buffer<Guide>& guides, bool single);

private:
    struct Float4 {
        float x, y, z, w;
    };
    struct Float2 {
        float x, y;
    };
    friend constexpr const char* device_type_name(const Float4*) { return "float4"; }
    friend constexpr const char* device_type_name(const Float2*) { return "float2"; }

    std::uint32_t width_, height_;
    Kernel demodulate_, estimate_, filter_, modulate_;
    Buffer<Float4> raw_, noisy_, filtered_[2], surfaces_;
    Buffer<Float2> slopes_;
    Buffer<float> weights_, image_;
};

}  // namespace claray
