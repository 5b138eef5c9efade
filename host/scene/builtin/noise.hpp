// Fractal noise for built-in landscapes, from + - * only: the same heights on every system.
#pragma once

#include <cmath>
#include <cstdint>

#include "host/base/random.hpp"

namespace claray::scenes {

/// Value noise: random values in [-1, 1] at integer points, joined by the quintic curve of Perlin 2002, whose first and
/// second derivatives vanish at the points.
[[nodiscard]] inline double value_noise(double x, double y, std::uint64_t seed) {
    const double fx = std::floor(x), fy = std::floor(y);
    const auto value = [&](int dx, int dy) {
        const auto ix = std::uint32_t(std::int64_t(fx) + dx), iy = std::uint32_t(std::int64_t(fy) + dy);
        return double(mix((std::uint64_t(ix) << 32 | iy) + seed * 0x9e3779b97f4a7c15u) >> 11) * 0x1p-52 - 1.0;
    };
    const auto smooth = [](double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); };
    const double u = smooth(x - fx), v = smooth(y - fy);
    const double lower = value(0, 0) + u * (value(1, 0) - value(0, 0));
    const double upper = value(0, 1) + u * (value(1, 1) - value(0, 1));
    return lower + v * (upper - lower);
}

/// Fractional Brownian motion: octaves of twice the frequency and `gain` times the amplitude, in (-1, 1) / (1 - gain).
/// Each octave is turned by atan(3/4), so that the lattices do not line up.
[[nodiscard]] inline double fractal_noise(double x, double y, unsigned octaves, std::uint64_t seed, double gain = 0.5) {
    double sum = 0.0, amplitude = 1.0;
    for (unsigned octave = 0; octave < octaves; ++octave) {
        sum += amplitude * value_noise(x, y, seed + octave);
        const double turned = 2.0 * (0.8 * x - 0.6 * y);
        y = 2.0 * (0.6 * x + 0.8 * y);
        x = turned;
        amplitude *= gain;
    }
    return sum;
}

}  // namespace claray::scenes
