// Estimates the noise of an image: its samples of even and of odd index are two independent renders. For means A
// and B of a and b samples, the expectation of (A - B)^2 a b / (a + b)^2 is the variance of the mean of all samples.
#include "claray/shared/path.h"
#include "math/vector.clh"

static inline float3 summed_by(ColorSum s) { return (float3)(s.r, s.g, s.b); }
static inline float3 lost_by(ColorSum s) { return (float3)(s.lost_r, s.lost_g, s.lost_b); }

/// The factor a b / (a + b)^2 of the numbers of samples of even and of odd index.
typedef struct Halves { float of_even, of_odd, of_all, of_square; } Halves;

static inline Halves halves_of(FilmPixel p) {
    const float even = (float)(p.count - p.odd_count), odd = (float)p.odd_count, of_all = 1.0f / (even + odd);
    const Halves h = {1.0f / even, 1.0f / odd, of_all, even * of_all * (odd * of_all)};
    return h;
}

static inline float luminance_sum(FilmPixel p) { return luminance(summed_by(p.all)) + luminance(lost_by(p.all)); }

/// For luminance, the only value of which a film has the sums of both halves: A - B.
static inline float noise_difference(FilmPixel p, Halves h, float scale) {
    const float sum = luminance_sum(p), odd_sum = p.odd_sum + p.odd_error;
    return ((sum - odd_sum) * h.of_even - odd_sum * h.of_odd) * scale;  // mutant: noise-unit
}

static inline void add_noise(NoiseSums* total, FilmPixel p, Halves h, float scale) {
    const float difference = noise_difference(p, h, scale);
    total->variance += difference * difference * h.of_square;
    total->luminance += luminance_sum(p) * h.of_all * scale;
    ++total->pixels;
}

static inline void add_sums(local NoiseSums* to, local const NoiseSums* from) {
    to->variance += from->variance;
    to->luminance += from->luminance;
    to->pixels += from->pixels;
    to->dropped += from->dropped;
}

/// Work-item w sums pixels w, w + items, ...; each work-group sums its items in local memory and writes one element of `sums`. `scale`
/// keeps squares within float32.
kernel __attribute__((reqd_work_group_size(CLARAY_SUM_GROUP, 1, 1)))
void measure_film(global const FilmPixel* film, uint pixels, float scale, uint items, global NoiseSums* sums) {
    const uint item = get_global_id(0);
    NoiseSums total = {0.0f, 0.0f, 0u, 0u};
    for (uint i = item; item < items && i < pixels; i += items) {
        const FilmPixel p = film[i];
        total.dropped += p.dropped;
        if (p.odd_count != 0u && p.odd_count != p.count) add_noise(&total, p, halves_of(p), scale);
    }
    local NoiseSums group[CLARAY_SUM_GROUP];
    const uint own = get_local_id(0);
    group[own] = total;
    for (uint left = CLARAY_SUM_GROUP / 2; left > 0; left /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < left) add_sums(&group[own], &group[own + left]);
    }
    if (own == 0) sums[get_group_id(0)] = group[0];
}

static inline float variance_of(FilmPixel p, float scale) {
    if (p.odd_count == 0u || p.odd_count == p.count) return 0.0f;
    const Halves halves = halves_of(p);
    const float difference = noise_difference(p, halves, scale);
    return difference * difference * halves.of_square;
}

/// Writes the variance of each pixel's mean luminance; 0 for pixels without samples of even and of odd index.
kernel void map_noise(global const FilmPixel* film, uint pixels, float scale, global float* variances) {
    const uint i = get_global_id(0);
    if (i < pixels) variances[i] = variance_of(film[i], scale);
}

/// The pixels of a tile of adaptive sampling.
typedef struct Tile { uint x0, y0, along, rows; } Tile;

static inline Tile tile_of(uint tile, uint width, uint height) {
    const uint side = CLARAY_TILE_SIDE, columns = (width + side - 1u) / side, x0 = tile % columns * side, y0 = tile / columns * side;
    const Tile t = {x0, y0, min(side, width - x0), min(side, height - y0)};
    return t;
}

/// Halves of a tile are the two colours of a checkerboard; its first pixel is of half 0.
static inline uint pixels_of_half(uint half_tile, uint along, uint rows) { return (along * rows + 1u - half_tile) / 2u; }

#define DARK 0.05f  // of the image's mean: darker pixels count as if they were not

/// What a sample of a pixel gains: its variance over the root of its luminance, both relative to the image's mean. Noise is seen more
/// easily where the image is dark. Cycles divides by the luminance itself (adaptive sampling, film kernels), which gains less squared error.
static inline float gain_of(FilmPixel p, float scale) {
    const float brightness = p.count == 0u ? 0.0f : fmax(luminance_sum(p) / (float)p.count * scale, 0.0f);
    return variance_of(p, scale) / sqrt(brightness + DARK);
}

/// The mean gain of the pixels of each half of a tile; 0 for a half without pixels. Half h of tile t is element 2 t + h.
kernel void map_gain(global const FilmPixel* film, uint width, uint height, float scale, global float* gain) {
    const uint item = get_global_id(0), half_tile = item % 2u;
    const uint tiles = ((width + CLARAY_TILE_SIDE - 1u) / CLARAY_TILE_SIDE) * ((height + CLARAY_TILE_SIDE - 1u) / CLARAY_TILE_SIDE);
    if (item >= 2u * tiles) return;
    const Tile t = tile_of(item / 2u, width, height);
    float sum = 0.0f;
    for (uint y = 0; y < t.rows; ++y)
        for (uint x = (y + half_tile) % 2u; x < t.along; x += 2u) sum += gain_of(film[(t.y0 + y) * width + t.x0 + x], scale);
    gain[item] = sum / (float)max(pixels_of_half(half_tile, t.along, t.rows), 1u);
}

/// Lists the entries of a round of adaptive sampling (Batch) from word `listed` of `tables` on. `halves`: three words each: half of a
/// tile, samples per pixel so far, first entry. An entry has `unit` samples. One item per pixel of a tile.
kernel void list_pixels(global const uint* halves, uint count, uint width, uint height, uint unit, global uint* tables, uint listed) {
    const uint most = CLARAY_TILE_SIDE * CLARAY_TILE_SIDE, number = (uint)get_global_id(0) / most, of_tile = (uint)get_global_id(0) % most;
    if (number >= count) return;
    const uint half_tile = halves[3u * number] % 2u, samples = halves[3u * number + 1u], first = halves[3u * number + 2u];
    const Tile t = tile_of(halves[3u * number] / 2u, width, height);
    const uint x = of_tile % CLARAY_TILE_SIDE, y = of_tile / CLARAY_TILE_SIDE;
    if (x >= t.along || y >= t.rows || (x + y) % 2u != half_tile) return;
    const uint before = pixels_of_half(half_tile, t.along, y) + x / 2u, entries = samples / unit;
    for (uint i = 0; i < entries; ++i) {
        const uint at = listed + 2u * (first + before * entries + i);
        tables[at] = (t.y0 + y) * width + t.x0 + x;
        tables[at + 1u] = samples + i * unit;
    }
}
