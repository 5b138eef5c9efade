// Films, guides and images made by hand.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "claray/shared/denoise.h"
#include "claray/shared/path.h"
#include "host/denoise/denoiser.hpp"

namespace claray::test {

/// Of a surface that faces the camera.
inline Guide flat_guide(float albedo, float glow, float nearness) {
    Guide g{};
    g.sampled_albedo_r = g.sampled_albedo_g = g.sampled_albedo_b = g.albedo_r = g.albedo_g = g.albedo_b = albedo;
    g.sampled_glow_r = g.sampled_glow_g = g.sampled_glow_b = g.glow_r = g.glow_g = g.glow_b = glow;
    g.normal_z = 1, g.nearness = nearness;
    return g;
}

/// The sums of a pixel's samples.
class PixelSamples {
public:
    void add(const glm::dvec3& sample) {
        const bool odd = count_++ % 2 != 0;
        sum_ += sample;
        if (odd) odd_ += 0.2126 * sample.x + 0.7152 * sample.y + 0.0722 * sample.z, ++odd_count_;
    }
    [[nodiscard]] FilmPixel pixel() const {
        FilmPixel p{};
        p.all = {float(sum_.x), float(sum_.y), float(sum_.z), 0, 0, 0};
        p.odd_sum = float(odd_), p.count = count_, p.odd_count = odd_count_;
        return p;
    }

private:
    glm::dvec3 sum_{0};
    double odd_ = 0;
    unsigned count_ = 0, odd_count_ = 0;
};

/// An image in the order of the device: on CPUs one value after the other of all pixels (denoise/light.clh).
inline Buffer<Float4> image_on(const Device& device, std::vector<Float4> pixels) {
    if (device.info().type != DeviceType::cpu) return {device, pixels};
    std::vector<Float4> planes(pixels.size());
    float* to = &planes[0].x;
    for (const auto value : {&Float4::x, &Float4::y, &Float4::z, &Float4::w})
        for (const Float4& pixel : pixels) *to++ = pixel.*value;
    return {device, planes};
}

inline std::vector<Float4> pixels_of(const Buffer<Float4>& image) {
    if (image.device().info().type != DeviceType::cpu) return image.read();
    const std::vector<Float4> planes = image.read();
    std::vector<Float4> pixels(planes.size());
    const float* from = &planes[0].x;
    for (const auto value : {&Float4::x, &Float4::y, &Float4::z, &Float4::w})
        for (Float4& pixel : pixels) pixel.*value = *from++;
    return pixels;
}

}  // namespace claray::test
