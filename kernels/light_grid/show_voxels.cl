// The voxel that each pixel shows, by the albedo of its surface.
#include "light_grid/light_grid.clh"
#include "shade/instance.clh"

/// One work-item per path of a batch of camera rays.
kernel void show_voxels(Step step, global const uint* tables, global const Ray* rays, global const SceneHit* hits, global float* albedo) {
    const uint path = get_global_id(0);
    if (path >= step.batch.pixels) return;
    float3 shown = (float3)(0.0f);
    global const uint* table = tables + step.frame.tables.light_grid;
    const uint levels = level_of_grid(table, 0)->levels;
    const Ray ray = queued_ray(&rays[path]);
    const float3 point = (float3)(ray.ox, ray.oy, ray.oz) + hits[path].t * (float3)(ray.dx, ray.dy, ray.dz);
    for (uint level = 0; hits[path].primitive != CLARAY_MISS && level < levels; ++level) {
        global const LightGrid* grid = level_of_grid(table, level);
        const float3 at = (point - (float3)(grid->x, grid->y, grid->z)) / step_of_grid(grid);
        if (share_of_level(grid, at, point) == 0.0f) continue;
        const uint3 voxel = convert_uint3(clamp(at + 0.5f, 0.0f, (float)(grid->side - 1)));
        shown = ((global const float4*)(table + grid->seen))[place_in_grid(grid, voxel)].xyz;
        break;
    }
    vstore3(shown, path, albedo);
}
