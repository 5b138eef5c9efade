// The light that a probe's rays found, as spherical harmonics: adds it to the mean over all its rays so far.
#include "light_grid/light_grid.clh"

/// One work-item per probe. A probe remembers at most `most_before` earlier rays: it follows lights that change.
kernel void gather_probes(Step step, GridBox box, float most_before, global uint* tables, global const float* radiance) {
    const uint probe = get_global_id(0), count = step.batch.samples;
    if (probe >= step.batch.pixels) return;
    global const uint* table = tables + step.frame.tables.light_grid;
    global const LightGrid* grid = level_of_grid(table, box.level);
    float3 sums[CLARAY_HARMONICS];
    for (uint i = 0; i < CLARAY_HARMONICS; ++i) sums[i] = (float3)(0.0f);
    const float2 shift = probe_shift(&step, probe);
    for (uint ray = 0; ray < count; ++ray) {
        const float3 found = load3(radiance, probe * count + ray), direction = probe_direction(shift, ray, count);
        if (!(largest(found) < INFINITY)) continue;
        float values[CLARAY_HARMONICS];
        claray_harmonics(direction.x, direction.y, direction.z, values);
        for (uint i = 0; i < CLARAY_HARMONICS; ++i) sums[i] += values[i] * found;
    }
    const uint place = place_in_grid(grid, item_of_box(&box, step.batch.first_pixel + probe));
    for (uint i = 0; i < CLARAY_HARMONICS; ++i) sums[i] *= 4.0f * PI / (float)count * claray_harmonic_of_cosine(i);
    global float4* probes = (global float4*)(tables + step.frame.tables.light_grid + grid->probes);
    blend_probe(probes + grid->coefficients * place, sums, grid->coefficients, (float)count, most_before);
}
