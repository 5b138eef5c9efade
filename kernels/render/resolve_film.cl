// From sums to an image, and how noisy it is.
#include "claray/shared/path.h"
#include "shade/vector.clh"

/// Mean radiance; black where a pixel has no sample.
kernel void resolve_film(global const FilmPixel* film, uint pixels, global float* image) {
    const uint i = get_global_id(0);
    if (i >= pixels) return;
    const FilmPixel p = film[i];
    const float3 sum = (float3)(p.sum_r, p.sum_g, p.sum_b) + (float3)(p.error_r, p.error_g, p.error_b);
    vstore3(p.count ? sum / (float)p.count : (float3)(0.0f), i, image);
}

/// Variance of a pixel's mean luminance, from its samples of even and of odd index, which are independent of each other: for
/// means A and B of a and b samples the expectation of (A - B)^2 a b / (a + b)^2.
static inline float variance_of_mean(FilmPixel p, float sum) {
    const float odd = (float)p.odd_count, even = (float)(p.count - p.odd_count);
    const float odd_sum = p.odd_sum + p.odd_error;
    const float difference = (sum - odd_sum) / even - odd_sum / odd;
    return difference * difference * (odd / (odd + even)) * (even / (odd + even));
}

/// Work-item w sums pixels w, w + items, ... into sums[w].
kernel void measure_noise(global const FilmPixel* film, uint pixels, uint items, global NoiseSums* sums) {
    const uint item = get_global_id(0);
    if (item >= items) return;
    NoiseSums total = {0.0f, 0.0f, 0u, 0u};
    for (uint i = item; i < pixels; i += items) {
        const FilmPixel p = film[i];
        total.dropped += p.dropped;
        if (p.odd_count == 0 || p.odd_count == p.count) continue;
        const float sum = luminance((float3)(p.sum_r, p.sum_g, p.sum_b)) + luminance((float3)(p.error_r, p.error_g, p.error_b));
        total.variance += variance_of_mean(p, sum);
        total.luminance += sum / (float)p.count;
        ++total.pixels;
    }
    sums[item] = total;
}
