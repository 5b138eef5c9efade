// Boxes around the surfaces that tiles show. A box of points in space needs no shape of the camera's: lenses, motion and parallel rays
// are no special cases.
#include "deferred/tiles.clh"
#include "shade/instance.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

static inline void grow_box(float3* lo, float3* hi, float3 point) { *lo = fmin(*lo, point), *hi = fmax(*hi, point); }

/// Grows the box by every `step`-th path from `first` on.
static inline void bound_paths(PathRange paths, uint first, uint step, global const Ray* rays, global const SceneHit* hits,
                               float3* lo, float3* hi) {
    for (uint path = paths.first + first; path < paths.end; path += step) {
        if (hits[path].primitive != CLARAY_MISS) grow_box(lo, hi, met_point(rays[path], hits[path].t));
    }
}

static inline void store_box(global TileBox* box, float3 lo, float3 hi) {
    const TileBox found = {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z};
    *box = found;
}

#if CLARAY_CPU
/// One work-item per tile.
kernel void bound_tiles(Step step, TileGrid tiles, global const Ray* rays, global const SceneHit* hits, global TileBox* boxes) {
    const uint tile = get_global_id(0);
    if (tile >= tiles.columns * tiles.rows) return;
    float3 lo = (float3)(INFINITY), hi = (float3)(-INFINITY);
    for (uint row = 0; row < CLARAY_TILE; ++row) bound_paths(paths_of_row(&step, &tiles, tile, row), 0, 1, rays, hits, &lo, &hi);
    store_box(&boxes[tile], lo, hi);
}
#else
/// One work-group per tile, with the same number of items for each row.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void bound_tiles(Step step, TileGrid tiles, global const Ray* rays, global const SceneHit* hits, global TileBox* boxes) {
    local float3 los[GROUP_SIZE], his[GROUP_SIZE];
    const uint tile = get_group_id(0), item = get_local_id(0), share = GROUP_SIZE / CLARAY_TILE;
    float3 lo = (float3)(INFINITY), hi = (float3)(-INFINITY);
    bound_paths(paths_of_row(&step, &tiles, tile, item / share), item % share, share, rays, hits, &lo, &hi);
    los[item] = lo, his[item] = hi;
    for (uint half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item < half_size) los[item] = fmin(los[item], los[item + half_size]), his[item] = fmax(his[item], his[item + half_size]);
    }
    if (item == 0) store_box(&boxes[tile], los[0], his[0]);
}
#endif
