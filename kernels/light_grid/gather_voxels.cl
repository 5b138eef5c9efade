// Voxels of surfaces as virtual point lights: the light that the surface in a voxel reflects, as spherical harmonics of the lobe around its
// normal. The harmonics are those of the light that arrives from there, so that the lookup is that of probes. Kaplanyan and
// Dachsbacher 2010, "Cascaded light propagation volumes for real-time indirect illumination", without the propagation.
#include "light_grid/light_grid.clh"
#include "shade/surface_at_hit.clh"

#define LOBE_MEAN 0.886226925f   // of a clamped cosine, in harmonic 0: sqrt(pi) / 2
#define LOBE_SLOPE 1.023326708f  // in band 1: sqrt(pi / 3)

/// One work-item per voxel. `most_before` as in gather_probes.
kernel void gather_voxels(Step step, GridBox box, float most_before, SCENE_PARAMETERS, global uint* grid_tables,
                          global const RayQueue* queue, global const SceneHit* hits, global const float* radiance) {
    const uint voxel = get_global_id(0);
    if (voxel >= step.batch.pixels) return;
    const FrameData* frame = &step.frame;
    float3 sums[4] = {(float3)(0.0f), (float3)(0.0f), (float3)(0.0f), (float3)(0.0f)}, albedo = (float3)(0.0f);
    uint count = 0;
    for (uint path = CLARAY_RAYS_PER_VOXEL * voxel; path < CLARAY_RAYS_PER_VOXEL * (voxel + 1); ++path) {
        if (hits[path].primitive == CLARAY_MISS) continue;
        ShadingPoint at;
        surface_seen(frame, SCENE, queued_ray((global const Ray*)queue + path), hits[path], &at);
        const float3 found = load3(radiance, path), normal = at.surface.geometric;
        albedo += albedo_of(&at.material), ++count;
        if (!(largest(found) < INFINITY)) continue;
        sums[0] += LOBE_MEAN * found;
        sums[1] -= LOBE_SLOPE * normal.y * found, sums[2] -= LOBE_SLOPE * normal.z * found, sums[3] -= LOBE_SLOPE * normal.x * found;
    }
    global const LightGrid* grid = level_of_grid(tables + frame->tables.light_grid, box.level);
    const uint place = place_in_grid(grid, item_of_box(&box, step.batch.first_pixel + voxel));
    global uint* table = grid_tables + frame->tables.light_grid;
    const float scale = 1.0f / (float)max(count, 1u);
    if (count > 0 || most_before == 0.0f)
        *((global float4*)(table + grid->seen) + place) = (float4)(albedo * scale, count > 0 ? 1.0f : 0.0f);
    // A thin surface is met from both sides, by half of the rays each.
    for (uint i = 0; i < 4; ++i) sums[i] *= 2.0f * scale * claray_harmonic_of_cosine(i);
    blend_probe((global float4*)(table + grid->probes) + grid->coefficients * place, sums, grid->coefficients, 1.0f, most_before);
}
