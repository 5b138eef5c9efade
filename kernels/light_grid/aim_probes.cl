// Rays of probes in random directions: paths that continue as if they had been scattered by a surface at the probe.
#include "light_grid/light_grid.clh"

/// One work-item per ray; probe p of the box is pixel p of the batch. Clears the radiance of the paths.
kernel void aim_probes(Step step, GridBox box, global const uint* tables, global RayQueue* queue, global float* radiance) {
    const uint path = get_global_id(0);
    if (path >= step.batch.pixels * step.batch.samples) return;
    global const LightGrid* grid = level_of_grid(tables + step.frame.tables.light_grid, box.level);
    const uint count = step.batch.samples, probe = path / count;
    const float3 from = probe_position(grid, item_of_box(&box, step.batch.first_pixel + probe));
    const float3 direction = probe_direction(probe_shift(&step, probe), path % count, count);
    const Ray ray = {from.x, from.y, from.z, 0.0f, direction.x, direction.y, direction.z, INFINITY};
    start_at_probe(&step, path, ray, sqrt(4.0f / (float)count), queue, radiance);
}
