// Rays from the parts of cells to the corners of these cells, to find out which probes each part sees.
#include "light_grid/light_grid.clh"

/// One work-item per ray; cell c of the box is pixel c of the batch.
kernel void aim_cells(Step step, GridBox box, global const uint* tables, global RayQueue* queue) {
    const uint path = get_global_id(0);
    if (path >= step.batch.pixels * CLARAY_RAYS_PER_CELL) return;
    global const LightGrid* grid = level_of_grid(tables + step.frame.tables.light_grid, box.level);
    const uint corner = path % 8, part = path / 8 % 64, parts = CLARAY_GRID_PARTS;
    const uint3 cell = item_of_box(&box, first_state(step.batch, 0, path).pixel);
    const float3 middle = (convert_float3((uint3)(part % parts, part / parts % parts, part / (parts * parts))) + 0.5f) / (float)parts;
    const float3 from = probe_position(grid, cell) + middle * step_of_grid(grid);
    const float3 way = probe_position(grid, cell + (uint3)(corner & 1u, corner >> 1 & 1u, corner >> 2)) - from;
    const Ray ray = {from.x, from.y, from.z, 0.0f, way.x, way.y, way.z, 1.0f};
    store_ray(&rays_of_queue(queue)[path], ray);
    if (INSTANCE_MOTION) times_of_queue(queue, step.room)[path] = 0.5f;
}
