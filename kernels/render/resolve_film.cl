// Computes the image from the sums.
#include "claray/shared/path.h"
#include "claray/shared/picture.h"
#include "math/vector.clh"

/// Mean radiance; black for a pixel without samples.
static inline float3 mean_of(FilmPixel p) {
    const float3 sum = (float3)(p.all.r, p.all.g, p.all.b) + (float3)(p.all.lost_r, p.all.lost_g, p.all.lost_b);
    return p.count ? sum / (float)p.count : (float3)(0.0f);
}

/// Where the centre of a pixel of the image is among the centres of the film's pixels: the pixel before it, and how far beyond.
static inline float2 place_in_film(uint pixel, uint pixels, uint of_film) {
    const float place = clamp(((float)pixel + 0.5f) * (float)of_film / (float)pixels - 0.5f, 0.0f, (float)(of_film - 1));
    return (float2)(floor(place), place - floor(place));
}

/// An image of another size than the film's is interpolated bilinearly.
kernel void resolve_film(global const FilmPixel* film, ImageSizes size, global float* image) {
    const uint i = get_global_id(0);
    if (i >= size.image_width * size.image_height) return;
    if (size.width == size.image_width && size.height == size.image_height) {
        vstore3(mean_of(film[i]), i, image);
        return;
    }
    const float2 x = place_in_film(i % size.image_width, size.image_width, size.width);
    const float2 y = place_in_film(i / size.image_width, size.image_height, size.height);
    const uint left = (uint)x.x, right = min(left + 1, size.width - 1);
    const uint top = (uint)y.x * size.width, bottom = min((uint)y.x + 1, size.height - 1) * size.width;
    const float3 above = lerp(mean_of(film[top + left]), mean_of(film[top + right]), x.y);
    const float3 below = lerp(mean_of(film[bottom + left]), mean_of(film[bottom + right]), x.y);
    vstore3(lerp(above, below, y.y), i, image);
}
