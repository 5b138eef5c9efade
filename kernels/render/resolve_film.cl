// From sums to an image.
#include "claray/shared/path.h"

/// Mean radiance; black where a pixel has no sample.
kernel void resolve_film(global const FilmPixel* film, uint pixels, global float* image) {
    const uint i = get_global_id(0);
    if (i >= pixels) return;
    const FilmPixel p = film[i];
    const float3 sum = (float3)(p.all.r, p.all.g, p.all.b) + (float3)(p.all.lost_r, p.all.lost_g, p.all.lost_b);
    vstore3(p.count ? sum / (float)p.count : (float3)(0.0f), i, image);
}
