// Rays of probes in random directions: paths that continue as if they had been scattered by a surface at the probe.
#include "light_grid/light_grid.clh"

/// One work-item per ray; probe p of the box is pixel p of the batch. Clears the radiance of the paths.
kernel void aim_probes(Step step, GridBox box, global const uint* tables, global RayQueue* queue, global float* radiance) {
    const uint path = get_global_id(0);
    if (path >= step.batch.pixels * step.batch.samples) return;
    global const LightGrid* grid = level_of_grid(tables + step.frame.tables.light_grid, box.level);
    const PathSamples samples = samples_of(step.batch, path, step.frame.seed);
    const float3 from = probe_position(grid, item_of_box(&box, pixel_of(step.batch, path)));
    const float3 direction = probe_direction(draw(samples, DIMENSION_FILM));
    const Ray ray = {from.x, from.y, from.z, 0.0f, direction.x, direction.y, direction.z, INFINITY};
    start_at_probe(&step, path, ray, sqrt(4.0f / (float)step.batch.samples), queue, radiance);
}
