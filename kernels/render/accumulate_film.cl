// Last stage of a batch: adds the radiance of paths to their pixels in the order of the samples. Therefore the sums depend neither
// on the size of batches nor on the order in which paths end.
#include "claray/shared/path.h"
#include "compute/textbook.clh"
#include "math/vector.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif
#define LARGEST_SAMPLE 1e30f  // 2^24 of these still fit in float32

/// Adds to a sum in two parts. The rounding error (Knuth's two-sum) goes to `error`; then as much of it as the sum can hold is
/// added back (Dekker 1971, fast two-sum). Without the second step the errors would be summed naively, and samples below half an
/// ulp of the sum would only reach the errors. Needs strict arithmetic.
static inline void add_exactly(float* sum, float* error, float value) {
#if CLARAY_TEXTBOOK_SUMS == 1
    *sum += value;
    return;
#elif CLARAY_TEXTBOOK_SUMS == 2
    ushort bits;
    vstore_half(*sum + value, 0, (half*)&bits);
    *sum = vload_half(0, (const half*)&bits);
    return;
#elif CLARAY_TEXTBOOK_SUMS == 3  // in 48 bits, as many as two floats hold
    const real exact = (real)*sum + *error + value;
    *sum = (float)exact;
    *error = (float)(exact - *sum);
    return;
#endif
    const float total = *sum + value, rounded = total - *sum;
    const float lost = *error + ((*sum - (total - rounded)) + (value - rounded));  // mutant: film-two-sum
    *sum = total + lost;  // mutant: film-fold-back
    *error = lost - (*sum - total);
}

/// Returns false for NaN, too.
static inline bool can_be_summed(float3 c) {
    return fabs(c.x) <= LARGEST_SAMPLE && fabs(c.y) <= LARGEST_SAMPLE && fabs(c.z) <= LARGEST_SAMPLE;  // mutant: film-nan
}

/// The sample, with its largest component scaled down to `limit`; 0 is no limit.
static inline float3 clamped(float3 c, float limit) {
    const float brightest = largest(fabs(c));
    return limit > 0.0f && brightest > limit ? c * (limit / brightest) : c;
}

static inline void add_color(ColorSum* sum, float3 c) {
    add_exactly(&sum->r, &sum->lost_r, c.x);
    add_exactly(&sum->g, &sum->lost_g, c.y);
    add_exactly(&sum->b, &sum->lost_b, c.z);
}

static inline void add_sample(FilmPixel* pixel, float3 sample, float limit, bool odd) {
    if (!can_be_summed(sample)) {
        ++pixel->dropped;
        return;
    }
    const float3 radiance = clamped(sample, limit);
    add_color(&pixel->all, radiance);
    ++pixel->count;
    if (!odd) return;
    add_exactly(&pixel->odd_sum, &pixel->odd_error, luminance(radiance));
    ++pixel->odd_count;
}

/// The pixel of the film that is number i of the batch. The list, if any, begins at `listed` in `tables`.
static inline uint film_pixel(Batch batch, global const uint* tables, uint listed, uint i) {
    return batch.listed ? tables[listed + 2u * (batch.first_pixel + i)] : batch.first_pixel + i;
}

/// One work-item adds all entries of a pixel, one after the other. Returns whether this is the first one in the batch.
static inline bool is_first_entry(Batch batch, global const uint* tables, uint listed, uint i) {
    return !batch.listed || i == 0u || film_pixel(batch, tables, listed, i) != film_pixel(batch, tables, listed, i - 1u);
}

static inline bool is_next_entry(Batch batch, global const uint* tables, uint listed, uint i) {
    return batch.listed && i < batch.pixels && !is_first_entry(batch, tables, listed, i);
}

#define NO_COLOR {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}

/// Pixel `at` of the film with the samples of the entries from i on. `begins`: the pixels have no samples yet, whatever the film
/// holds. `limit`: of a sample's components; 0 is none.
static inline FilmPixel summed_pixel(Batch batch, global const uint* tables, uint listed, uint begins, float limit,
                                     global const float* radiance, global const FilmPixel* film, uint i, uint at) {
    FilmPixel pixel = {NO_COLOR, 0.0f, 0.0f, 0u, 0u, 0u};
    if (!begins) pixel = film[at];
    do {
        for (uint s = 0; s < batch.samples; ++s)  // the numbers of entries are even
            add_sample(&pixel, vload3(i * batch.samples + s, radiance), limit, (batch.first_sample + s) & 1);
    } while (is_next_entry(batch, tables, listed, ++i));
    return pixel;
}

/// Counts the samples that batches which begin their pixels leave out. They are few.
static inline void count_dropped(FilmPixel pixel, uint begins, volatile global uint* dropped) {
    if (begins && pixel.dropped != 0u) atomic_add(dropped, pixel.dropped);
}

#if CLARAY_CPU
/// The pixel with one sample, whose sums need no rounding.
static inline FilmPixel pixel_of_one(float3 sample, float limit, bool odd) {
    const bool counts = can_be_summed(sample);
    const float3 c = counts ? clamped(sample, limit) : (float3)(0.0f);
    const uint one = counts ? 1u : 0u;
    const FilmPixel pixel = {{c.x, c.y, c.z, 0.0f, 0.0f, 0.0f}, odd ? luminance(c) : 0.0f, 0.0f, one, odd ? one : 0u, 1u - one};
    return pixel;
}

kernel void accumulate_film(Batch batch, global const uint* tables, uint listed, uint begins, float limit,
                            global const float* radiance, global FilmPixel* film, volatile global uint* dropped) {
    const uint i = get_global_id(0);
    if (i >= batch.pixels || !is_first_entry(batch, tables, listed, i)) return;
    const uint at = film_pixel(batch, tables, listed, i);
    const bool one = CLARAY_TEXTBOOK_SUMS ? false : begins && batch.samples == 1u && !batch.listed;
    const FilmPixel pixel = one ? pixel_of_one(vload3(i, radiance), limit, batch.first_sample & 1u)
                                : summed_pixel(batch, tables, listed, begins, limit, radiance, film, i, at);
    count_dropped(pixel, begins, dropped);
    film[at] = pixel;
}
#else
/// A group stores its neighbouring pixels word by word out of local memory. If each item stored its own eleven words, each of the
/// eleven stores would touch all the sectors of the group's pixels.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void accumulate_film(Batch batch, global const uint* tables, uint listed, uint begins, float limit, global const float* radiance,
                     global FilmPixel* film, volatile global uint* dropped) {
    local FilmPixel pixels[GROUP_SIZE];
    const uint i = get_global_id(0), own = get_local_id(0), first = i - own;
    if (i < batch.pixels && is_first_entry(batch, tables, listed, i)) {
        const uint at = film_pixel(batch, tables, listed, i);
        pixels[own] = summed_pixel(batch, tables, listed, begins, limit, radiance, film, i, at);
        count_dropped(pixels[own], begins, dropped);
        if (batch.listed) film[at] = pixels[own];
    }
    if (batch.listed || first >= batch.pixels) return;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint words = min((uint)GROUP_SIZE, batch.pixels - first) * (uint)(sizeof(FilmPixel) / sizeof(uint));
    local const uint* from = (local const uint*)pixels;
    global uint* to = (global uint*)(film + batch.first_pixel + first);
    for (uint word = own; word < words; word += GROUP_SIZE) to[word] = from[word];
}
#endif
