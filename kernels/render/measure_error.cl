// How far an image is off: its samples of even and of odd index are two renders that are independent of each other.
#include "claray/shared/path.h"
#include "shade/vector.clh"

static inline float3 sum_of(FilmPixel p) { return (float3)(p.sum_r, p.sum_g, p.sum_b); }
static inline float3 lost_by(FilmPixel p) { return (float3)(p.error_r, p.error_g, p.error_b); }

/// Work-item w sums pixels w, w + items, ... into sums[w]. `film` has all samples, and behind them those of odd index once
/// more. Of means A and B of a and b samples, the expectation of (A - B)^2 a b / (a + b)^2 is the variance of the mean of
/// all. `scale` keeps fourth powers within float32.
kernel void measure_error(global const FilmPixel* film, uint pixels, float scale, uint items, global ErrorSums* sums) {
    const uint item = get_global_id(0);
    if (item >= items) return;
    ErrorSums total = {0.0f, 0.0f, 0.0f, 0u};
    for (uint i = item; i < pixels; i += items) {
        const FilmPixel all = film[i], odd = film[(size_t)pixels + i];
        if (odd.count == 0u || odd.count == all.count) continue;
        const float a = (float)(all.count - odd.count), b = (float)odd.count, count = (float)all.count;
        const float3 sum_of_even = (sum_of(all) - sum_of(odd)) + (lost_by(all) - lost_by(odd));
        const float3 difference = (sum_of_even / a - (sum_of(odd) + lost_by(odd)) / b) * scale;
        const float variance = dot(difference, difference) * (a / count) * (b / count);
        total.variance += variance;
        total.squares += variance * variance;
        total.value += dot((sum_of(all) + lost_by(all)) / count * scale, (float3)(1.0f));
        ++total.pixels;
    }
    sums[item] = total;
}
