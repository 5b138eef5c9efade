// Rays of probes in random directions: paths that continue as if they had been scattered by a surface at the probe.
#include "light_grid/light_grid.clh"
#include "render/queue.clh"

#ifndef INSTANCE_MOTION
#define INSTANCE_MOTION 0
#endif

#define PROBE_PDF 1e-30f  // so small that light that surfaces sample themselves has no weight: see power_heuristic

/// One work-item per ray; probe p of the box is pixel p of the batch. Clears the radiance of the paths.
kernel void aim_probes(Step step, GridBox box, global const uint* tables, global RayQueue* queue, global float* radiance) {
    const uint path = get_global_id(0);
    if (path >= step.batch.pixels * step.batch.samples) return;
    global const LightGrid* grid = level_of_grid(tables + step.frame.tables.light_grid, box.level);
    const PathSamples samples = samples_of(step.batch, path, step.frame.seed);
    const float3 from = probe_position(grid, item_of_box(&box, pixel_of(step.batch, path)));
    const float3 direction = probe_direction(draw(samples, DIMENSION_FILM));
    const Ray ray = {from.x, from.y, from.z, 0.0f, direction.x, direction.y, direction.z, INFINITY};
    const PathState state = {1.0f, 1.0f, 1.0f, PROBE_PDF, path};
    const RayCone cone = {0.0f, sqrt(4.0f / (float)step.batch.samples)};
    store_ray(&rays_of_queue(queue)[path], ray);
    states_of_queue(queue, step.room)[path] = state;
    cones_of_queue(queue, step.room)[path] = cone;
#if INSTANCE_MOTION
    times_of_queue(queue, step.room)[path] = time_of(samples);
#endif
    vstore3((float3)(0.0f), path, radiance);
    if (step.frame.tables.light_tree != CLARAY_NO_TABLE) vstore3(direction, path, radiance + 3 * (size_t)step.room);
}
