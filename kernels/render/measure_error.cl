// How far the mean of two films is off, which are independent renders of the same image.
#include "claray/shared/path.h"
#include "shade/vector.clh"

static inline float3 mean_of(FilmPixel p) {
    const float3 sum = (float3)(p.sum_r, p.sum_g, p.sum_b) + (float3)(p.error_r, p.error_g, p.error_b);
    return sum / (float)p.count;
}

/// Work-item w sums pixels w, w + items, ... into sums[w]. Of means A and B of a and b samples, the expectation of
/// (A - B)^2 a b / (a + b)^2 is the variance of the mean of all. `scale` keeps fourth powers within float32.
kernel void measure_error(global const FilmPixel* film, uint pixels, float scale, uint items, global ErrorSums* sums) {
    const uint item = get_global_id(0);
    if (item >= items) return;
    ErrorSums total = {0.0f, 0.0f, 0.0f, 0u};
    for (uint i = item; i < pixels; i += items) {
        const FilmPixel p = film[i], q = film[(size_t)pixels + i];
        if (p.count == 0u || q.count == 0u) continue;
        const float a = (float)p.count / ((float)p.count + (float)q.count), b = 1.0f - a;
        const float3 of_a = mean_of(p) * scale, of_b = mean_of(q) * scale, difference = of_a - of_b;
        const float variance = dot(difference, difference) * a * b;
        total.variance += variance;
        total.squares += variance * variance;
        total.value += dot(a * of_a + b * of_b, (float3)(1.0f));
        ++total.pixels;
    }
    sums[item] = total;
}
