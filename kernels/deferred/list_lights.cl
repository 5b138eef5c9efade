// Lists of the lights that may reach the surfaces of tiles, on two levels: blocks of tiles choose among all lights, and tiles among those
// of their block (Harada, McKee and Yang 2012, "Forward+", use one level). A list keeps the order of the lights, so that sums over it
// are those over all lights bit for bit.
#include "deferred/tiles.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif
#define MARGIN 1e-4f  // of a range and of coordinates, against rounding

static inline TileBox box_of_block(const TileGrid* tiles, global const TileBox* boxes, uint block) {
    const uint x0 = block % tiles->block_columns * CLARAY_TILE_BLOCK, y0 = block / tiles->block_columns * CLARAY_TILE_BLOCK;
    TileBox all = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    for (uint y = y0; y < min(y0 + CLARAY_TILE_BLOCK, tiles->rows); ++y)
        for (uint x = x0; x < min(x0 + CLARAY_TILE_BLOCK, tiles->columns); ++x) {
            const TileBox box = boxes[y * tiles->columns + x];
            all.lo_x = fmin(all.lo_x, box.lo_x), all.lo_y = fmin(all.lo_y, box.lo_y), all.lo_z = fmin(all.lo_z, box.lo_z);
            all.hi_x = fmax(all.hi_x, box.hi_x), all.hi_y = fmax(all.hi_y, box.hi_y), all.hi_z = fmax(all.hi_z, box.hi_z);
        }
    return all;
}

/// Whether the cone may reach the sphere: beside its border, in the plane through both axes.
static inline bool cone_reaches(global const PunctualLight* light, float3 towards, float radius) {
    const float cosine = -light->cone_offset / light->cone_scale, sine = sqrt(fmax(1.0f - cosine * cosine, 0.0f));
    const float along = dot(towards, (float3)(light->direction_x, light->direction_y, light->direction_z));
    const float beside = sqrt(fmax(dot(towards, towards) - along * along, 0.0f));
    return beside * cosine - along * sine <= radius && along >= -radius;
}

/// Whether a light may reach a point of the box.
static inline bool may_reach(global const PunctualLight* light, float3 lo, float3 hi) {
    if (is_far_kind(light->kind)) return true;
    const float3 place = (float3)(light->x, light->y, light->z), size = fmax(fabs(lo), fabs(hi));
    const float3 wide = MARGIN * 1e-2f * fmax(size, fabs(place)), off = fmax(fmax(lo - wide - place, place - hi - wide), 0.0f);
    const float range = (1.0f + MARGIN) / light->inverse_range;  // infinite without a range; its square is used
    if (dot(off, off) > range * range) return false;
    if (!is_cone_kind(light->kind)) return true;
    return cone_reaches(light, 0.5f * (lo + hi) - place, 0.5f * length(hi - lo + 2.0f * wide));
}

/// Makes the lists of blocks (`of_blocks`) or of tiles, one per work-item on CPUs and one per group on GPUs. `block_lists` are read
/// for tiles only.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void list_lights(TileGrid tiles, uint of_blocks, global const uint* tables, uint where, global const TileBox* boxes,
                 global const uint* block_lists, global uint* lists) {
    global const PunctualLight* lights = (global const PunctualLight*)(tables + where);
    const uint number = CLARAY_CPU ? get_global_id(0) : get_group_id(0);
    const uint room = of_blocks ? tiles.block_room : tiles.tile_room;
    if (CLARAY_CPU && number >= (of_blocks ? tiles.block_columns * tiles.block_rows : tiles.columns * tiles.rows)) return;
    const TileLights all = {0, tiles.lights};
    const TileLights from = of_blocks ? all : lights_of_block(&tiles, block_lists, block_of_tile(&tiles, number));
    const TileBox box = of_blocks ? box_of_block(&tiles, boxes, number) : boxes[number];
    const float3 lo = (float3)(box.lo_x, box.lo_y, box.lo_z), hi = (float3)(box.hi_x, box.hi_y, box.hi_z);
    const uint end = lo.x <= hi.x ? from.count : 0;
    global uint* list = lists + (size_t)number * (room + 1);
    uint count = 0;
#if CLARAY_CPU
    for (uint i = 0; i < end && count <= room; ++i) {
        const uint light = light_in_list(from, i);
        if (!may_reach(&lights[light], lo, hi)) continue;
        if (count < room) list[1 + count] = light;
        ++count;
    }
    list[0] = count <= room ? count : CLARAY_ALL_LIGHTS;
#else
    local uint kept[GROUP_SIZE];
    const uint item = get_local_id(0);
    for (uint begin = 0; begin < end; begin += GROUP_SIZE) {
        const uint i = begin + item, light = i < end ? light_in_list(from, i) : 0;
        const bool wanted = i < end && may_reach(&lights[light], lo, hi);
        kept[item] = wanted;
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint step = 1; step < GROUP_SIZE; step *= 2) {  // inclusive prefix sums
            const uint before = item >= step ? kept[item - step] : 0;
            barrier(CLK_LOCAL_MEM_FENCE);
            kept[item] += before;
            barrier(CLK_LOCAL_MEM_FENCE);
        }
        const uint at = count + kept[item] - 1;
        if (wanted && at < room) list[1 + at] = light;
        count += kept[GROUP_SIZE - 1];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (item == 0) list[0] = count <= room ? count : CLARAY_ALL_LIGHTS;
#endif
}
