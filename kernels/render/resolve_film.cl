// Computes the image from the sums.
#include "claray/shared/path.h"

/// Mean radiance; black for a pixel without samples.
kernel void resolve_film(global const FilmPixel* film, uint pixels, global float* image) {
    const uint i = get_global_id(0);
    if (i >= pixels) return;
    const FilmPixel p = film[i];
    const float3 sum = (float3)(p.all.r, p.all.g, p.all.b) + (float3)(p.all.lost_r, p.all.lost_g, p.all.lost_b);
    vstore3(p.count ? sum / (float)p.count : (float3)(0.0f), i, image);
}
