// Rays of probes in all directions: paths that continue as if they had been scattered by a surface at the probe.
#include "light_grid/light_grid.clh"

static inline void aim_ray(const Step* step, uint path, float3 from, float3 direction, global RayQueue* queue, global float* radiance) {
    const Ray ray = {from.x, from.y, from.z, 0.0f, direction.x, direction.y, direction.z, INFINITY};
    start_at_probe(step, path, ray, sqrt(4.0f / (float)step->batch.samples), queue, radiance);
}

/// Probe p of the box is pixel p of the batch. Clears the radiance of the paths. One work-item per probe on CPUs, else per ray.
kernel void aim_probes(Step step, GridBox box, global const uint* tables, global RayQueue* queue, global float* radiance) {
    const uint count = step.batch.samples, item = get_global_id(0), probe = CLARAY_CPU ? item : item / count;
    if (probe >= step.batch.pixels) return;
    global const LightGrid* grid = level_of_grid(tables + step.frame.tables.light_grid, box.level);
    const float3 from = probe_position(grid, item_of_box(&box, step.batch.first_pixel + probe));
    const float2 shift = probe_shift(&step, probe);
#if CLARAY_CPU
    for (uint first = 0; first < count; first += 16) {
        Lanes16 lanes;
        keep_vectors16(probe_directions16(shift, first, count), &lanes, 0);
        for (uint i = 0; i < min(16u, count - first); ++i)
            aim_ray(&step, count * probe + first + i, from, lane_vector16(&lanes, 0, i), queue, radiance);
    }
#else
    aim_ray(&step, item, from, probe_direction(shift, item % count, count), queue, radiance);
#endif
}
