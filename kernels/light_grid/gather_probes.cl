// The light that a probe's rays found, as spherical harmonics: adds it to the mean over all its rays so far.
#include "light_grid/light_grid.clh"

#if CLARAY_CPU
/// Sum over 16 rays from `first` on of the harmonics times the radiance that the rays found.
static inline void add_rays16(float2 shift, uint first, uint count, global const float* radiance, float16 (*sums)[3]) {
    Lanes16 found;
    for (uint lane = 0; lane < 16; ++lane) {
        const float3 one = first + lane < count ? load3(radiance, first + lane) : (float3)(0.0f);
        const bool counts = largest(one) < INFINITY;
        found.value[0][lane] = counts ? one.x : 0.0f, found.value[1][lane] = counts ? one.y : 0.0f;
        found.value[2][lane] = counts ? one.z : 0.0f;
    }
    const Vectors direction = probe_directions16(shift, first, count), light = lane_vectors16(&found, 0);
    float16 values[CLARAY_HARMONICS];
    CLARAY_FIND_HARMONICS(direction.x, direction.y, direction.z, values);
    for (uint i = 0; i < CLARAY_HARMONICS; ++i)
        sums[i][0] += values[i] * light.x, sums[i][1] += values[i] * light.y, sums[i][2] += values[i] * light.z;
}

static inline float sum_of_lanes(float16 v) {
    const float8 a = v.lo + v.hi;
    const float4 b = a.lo + a.hi;
    return (b.x + b.y) + (b.z + b.w);
}

static inline void sum_rays(float2 shift, uint count, global const float* radiance, float3* sums) {
    float16 lanes[CLARAY_HARMONICS][3];
    for (uint i = 0; i < CLARAY_HARMONICS; ++i) lanes[i][0] = lanes[i][1] = lanes[i][2] = (float16)(0.0f);
    for (uint first = 0; first < count; first += 16) add_rays16(shift, first, count, radiance, lanes);
    for (uint i = 0; i < CLARAY_HARMONICS; ++i)
        sums[i] = (float3)(sum_of_lanes(lanes[i][0]), sum_of_lanes(lanes[i][1]), sum_of_lanes(lanes[i][2]));
}
#else
static inline void sum_rays(float2 shift, uint count, global const float* radiance, float3* sums) {
    for (uint i = 0; i < CLARAY_HARMONICS; ++i) sums[i] = (float3)(0.0f);
    for (uint ray = 0; ray < count; ++ray) {
        const float3 found = load3(radiance, ray), direction = probe_direction(shift, ray, count);
        if (!(largest(found) < INFINITY)) continue;
        float values[CLARAY_HARMONICS];
        claray_harmonics(direction.x, direction.y, direction.z, values);
        for (uint i = 0; i < CLARAY_HARMONICS; ++i) sums[i] += values[i] * found;
    }
}
#endif

/// One work-item per probe. A probe remembers at most `most_before` earlier rays: it follows lights that change.
kernel void gather_probes(Step step, GridBox box, float most_before, global uint* tables, global const float* radiance) {
    const uint probe = get_global_id(0), count = step.batch.samples;
    if (probe >= step.batch.pixels) return;
    global const uint* table = tables + step.frame.tables.light_grid;
    global const LightGrid* grid = level_of_grid(table, box.level);
    float3 sums[CLARAY_HARMONICS];
    sum_rays(probe_shift(&step, probe), count, radiance + 3 * (size_t)count * probe, sums);
    const uint place = place_in_grid(grid, item_of_box(&box, step.batch.first_pixel + probe));
    for (uint i = 0; i < CLARAY_HARMONICS; ++i) sums[i] *= 4.0f * PI / (float)count * claray_harmonic_of_cosine(i);
    global float4* probes = (global float4*)(tables + step.frame.tables.light_grid + grid->probes);
    blend_probe(probes + grid->coefficients * place, sums, grid->coefficients, (float)count, most_before);
}
