// Estimates the noise and the error of an image: its samples of even and of odd index are two independent renders. For means A
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

/// For all channels.
static inline void add_error(ErrorSums* total, ColorSum all, ColorSum odd, Halves h, float scale) {
    const float3 even_sum = (summed_by(all) - summed_by(odd)) + (lost_by(all) - lost_by(odd));  // mutant: error-odd-half
    const float3 difference = (even_sum * h.of_even - (summed_by(odd) + lost_by(odd)) * h.of_odd) * scale;
    const float variance = dot(difference, difference) * h.of_square;
    total->variance += variance;
    total->squares += variance * variance;
    total->value += dot((summed_by(all) + lost_by(all)) * h.of_all * scale, (float3)(1.0f));
    ++total->pixels;
}

#if GROUP_SIZE > 1
static inline void add_sums(local FilmSums* to, local const FilmSums* from) {
    to->noise.variance += from->noise.variance;
    to->noise.luminance += from->noise.luminance;
    to->noise.pixels += from->noise.pixels;
    to->noise.dropped += from->noise.dropped;
    to->error.variance += from->error.variance;
    to->error.squares += from->error.squares;
    to->error.value += from->error.value;
    to->error.pixels += from->error.pixels;
}
#endif

/// Work-item w sums pixels w, w + items, ...; each work-group sums its items in local memory and writes one element of `sums`. The
/// error is computed if `odd` holds the colours of the samples of odd index. `scale` keeps fourth powers within float32.
kernel void measure_film(global const FilmPixel* film, global const ColorSum* odd, uint has_odd, uint pixels, float scale, uint items,
                         global FilmSums* sums) {
    const uint item = get_global_id(0);
    FilmSums total = {{0.0f, 0.0f, 0u, 0u}, {0.0f, 0.0f, 0.0f, 0u}};
    for (uint i = item; item < items && i < pixels; i += items) {
        const FilmPixel p = film[i];
        const ColorSum its_odd = odd[has_odd ? i : 0u];  // both loads are issued before either is used
        total.noise.dropped += p.dropped;
        if (p.odd_count == 0u || p.odd_count == p.count) continue;
        const Halves halves = halves_of(p);
        add_noise(&total.noise, p, halves, scale);
        if (has_odd) add_error(&total.error, p.all, its_odd, halves, scale);
    }
#if GROUP_SIZE > 1
    local FilmSums group[GROUP_SIZE];
    const uint own = get_local_id(0);
    group[own] = total;
    for (uint left = GROUP_SIZE; left > 1;) {
        const uint upper = left / 2;  // number of items whose sums are added to lower items
        left -= upper;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (own < upper) add_sums(&group[own], &group[own + left]);
    }
    if (own == 0) sums[get_group_id(0)] = group[0];
#else
    if (item < items) sums[item] = total;
#endif
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

/// The same for the mean of each tile's pixels, row by row.
kernel void map_tile_noise(global const FilmPixel* film, uint width, uint height, float scale, global float* variances) {
    const uint columns = (width + CLARAY_TILE_SIDE - 1u) / CLARAY_TILE_SIDE, rows = (height + CLARAY_TILE_SIDE - 1u) / CLARAY_TILE_SIDE;
    const uint tile = get_global_id(0);
    if (tile >= columns * rows) return;
    const uint x0 = tile % columns * CLARAY_TILE_SIDE, y0 = tile / columns * CLARAY_TILE_SIDE;
    const uint x1 = min(x0 + CLARAY_TILE_SIDE, width), y1 = min(y0 + CLARAY_TILE_SIDE, height);
    float sum = 0.0f;
    for (uint y = y0; y < y1; ++y)
        for (uint x = x0; x < x1; ++x) sum += variance_of(film[y * width + x], scale);
    variances[tile] = sum / (float)((x1 - x0) * (y1 - y0));
}

/// Lists the entries of a round of adaptive sampling (Batch) from word `listed` of `tables` on. `tiles`: three words each: tile, samples
/// per pixel so far, first entry. An entry has `unit` samples. One item per pixel of a tile.
kernel void list_pixels(global const uint* tiles, uint count, uint width, uint height, uint unit, global uint* tables, uint listed) {
    const uint most = CLARAY_TILE_SIDE * CLARAY_TILE_SIDE, number = (uint)get_global_id(0) / most, of_tile = (uint)get_global_id(0) % most;
    if (number >= count) return;
    const uint columns = (width + CLARAY_TILE_SIDE - 1u) / CLARAY_TILE_SIDE;
    const uint tile = tiles[3u * number], samples = tiles[3u * number + 1u], first = tiles[3u * number + 2u];
    const uint x0 = tile % columns * CLARAY_TILE_SIDE, y0 = tile / columns * CLARAY_TILE_SIDE;
    const uint along = min((uint)CLARAY_TILE_SIDE, width - x0), rows = min((uint)CLARAY_TILE_SIDE, height - y0);
    if (of_tile >= along * rows) return;
    const uint pixel = (y0 + of_tile / along) * width + x0 + of_tile % along, entries = samples / unit;
    for (uint i = 0; i < entries; ++i) {
        const uint at = listed + 2u * (first + of_tile * entries + i);
        tables[at] = pixel;
        tables[at + 1u] = samples + i * unit;
    }
}
