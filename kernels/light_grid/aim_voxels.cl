// Short rays through voxels, the cubes around the probes' places: from each side to the opposite one, at a random place.
#include "light_grid/light_grid.clh"

/// One work-item per ray; voxel v of the box is pixel v of the batch, with CLARAY_RAYS_PER_VOXEL rays. Clears the radiance of the paths.
kernel void aim_voxels(Step step, GridBox box, global const uint* tables, global RayQueue* queue, global float* radiance) {
    const uint path = get_global_id(0), side = path % CLARAY_RAYS_PER_VOXEL;
    if (path >= step.batch.pixels * CLARAY_RAYS_PER_VOXEL) return;
    global const LightGrid* grid = level_of_grid(tables + step.frame.tables.light_grid, box.level);
    const float3 size = step_of_grid(grid);
    const uint3 axis = (uint3)(0, 1, 2);
    const PathState state = first_state(step.batch, 0, path);
    const float2 random = draw(samples_of(state, step.frame.seed), DIMENSION_FILM) - 0.5f;
    const float3 way = select((float3)(0.0f), side < 3 ? size : -size, axis == side % 3);
    const float3 beside = select((float3)(0.0f), size, axis == (side + 1) % 3) * random.x +
                          select((float3)(0.0f), size, axis == (side + 2) % 3) * random.y;
    const float3 from = probe_position(grid, item_of_box(&box, state.pixel)) + beside - 0.5f * way;
    const Ray ray = {from.x, from.y, from.z, 0.0f, way.x, way.y, way.z, 1.0f};
    start_at_probe(&step, path, ray, 0.0f, queue, radiance);
}
