// Films and guides made by hand.
#pragma once

#include <glm/glm.hpp>

#include "claray/shared/denoise.h"
#include "claray/shared/path.h"

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

}  // namespace claray::test
