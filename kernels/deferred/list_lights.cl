// Lists of the lights that may reach the surfaces of tiles, on two levels: blocks of tiles choose among all lights, and tiles among those
// of their block (Harada, McKee and Yang 2012, "Forward+", use one level). A list keeps the order of the lights, so that sums over it
// are those over all lights bit for bit.
#include "deferred/tiles.clh"
#include "math/vector_sixteen.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif
#define MARGIN 1e-4f  // of a range, against rounding
#define NARROW 1e-6f  // the same of coordinates
#define NO_CONE -2.0f

/// Writes where lights can shine: position, range, axis, and the cosine of the cone's angle or NO_CONE. Each number has an array, so
/// that neighbouring items or lanes read neighbouring words.
kernel void bound_lights(global const uint* tables, uint where, uint count, uint stride, global float* bounds) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const PunctualLight light = ((global const PunctualLight*)(tables + where))[i];
    const float range = is_far_kind(light.kind) ? INFINITY : fabs((1.0f + MARGIN) / light.inverse_range);  // infinite without one
    const float cosine = is_cone_kind(light.kind) && !is_far_kind(light.kind) ? -light.cone_offset / light.cone_scale : NO_CONE;
    const float numbers[CLARAY_LIGHT_BOUNDS] = {light.x, light.y, light.z, range, light.direction_x, light.direction_y, light.direction_z, cosine};
    for (uint k = 0; k < CLARAY_LIGHT_BOUNDS; ++k) bounds[k * stride + i] = numbers[k];
}

#if CLARAY_CPU
#define AT_ONCE 16u
typedef float16 Reals;
typedef int16 Truths;
#else
#define AT_ONCE 1u
typedef float Reals;
typedef int Truths;
#endif

/// Where lights can shine: on CPUs sixteen lights.
typedef struct LightBounds {
    Reals x, y, z, range;
    Reals axis_x, axis_y, axis_z, cosine;
} LightBounds;

/// Four numbers, from number `first` on, of the lights from number `i` of a list on. Those beyond its end are undefined.
static inline void load_bounds(global const float* bounds, uint stride, TileLights list, uint i, uint first, Reals* a, Reals* b, Reals* c, Reals* d) {
    global const float *row_a = bounds + first * stride, *row_b = row_a + stride, *row_c = row_b + stride, *row_d = row_c + stride;
#if CLARAY_CPU
    if (!list.index) {
        *a = vload16(0, row_a + i), *b = vload16(0, row_b + i), *c = vload16(0, row_c + i), *d = vload16(0, row_d + i);
        return;
    }
    for (uint lane = 0; lane < 16; ++lane) {
        const uint light = list.index[min(i + lane, list.count - 1)];
        ((float*)a)[lane] = row_a[light], ((float*)b)[lane] = row_b[light], ((float*)c)[lane] = row_c[light], ((float*)d)[lane] = row_d[light];
    }
#else
    const uint light = light_in_list(list, i);
    *a = row_a[light], *b = row_b[light], *c = row_c[light], *d = row_d[light];
#endif
}

/// Upper bounds of the rounding of coordinates in a box and of lights.
static inline Reals rounding_of(float lo, float hi, Reals place) { return NARROW * max((Reals)(max(fabs(lo), fabs(hi))), fabs(place)); }

static inline Reals distance_along(float lo, float hi, Reals place) {
    const Reals wide = rounding_of(lo, hi, place);
    return max(max(lo - wide - place, place - hi - wide), (Reals)(0.0f));
}

/// Whether lights are near enough to reach a point of the box, which must not be empty.
static inline Truths spheres_reach(const LightBounds* light, const TileBox* box) {
    const Reals x = distance_along(box->lo_x, box->hi_x, light->x), y = distance_along(box->lo_y, box->hi_y, light->y);
    const Reals z = distance_along(box->lo_z, box->hi_z, light->z);
    return x * x + y * y + z * z <= light->range * light->range;
}

static inline Reals size_along(float lo, float hi, Reals place) { return hi - lo + 2.0f * rounding_of(lo, hi, place); }

/// Whether their cones may reach the sphere around the box: beside their borders, in the plane through both axes.
static inline Truths cones_reach(const LightBounds* light, const TileBox* box) {
    const Reals x = 0.5f * (box->lo_x + box->hi_x) - light->x, y = 0.5f * (box->lo_y + box->hi_y) - light->y;
    const Reals z = 0.5f * (box->lo_z + box->hi_z) - light->z;
    const Reals size_x = size_along(box->lo_x, box->hi_x, light->x), size_y = size_along(box->lo_y, box->hi_y, light->y);
    const Reals size_z = size_along(box->lo_z, box->hi_z, light->z);
    const Reals radius = 0.5f * sqrt(size_x * size_x + size_y * size_y + size_z * size_z);
    const Reals along = x * light->axis_x + y * light->axis_y + z * light->axis_z;
    const Reals beside = sqrt(max(x * x + y * y + z * z - along * along, (Reals)(0.0f)));
    const Reals sine = sqrt(max(1.0f - light->cosine * light->cosine, (Reals)(0.0f)));
    const Reals wide = radius + NARROW * (fabs(along) + beside);
    return (light->cosine == NO_CONE) | ((beside * light->cosine - along * sine <= wide) & (along >= -wide));
}

static inline bool is_empty(const TileBox* box) { return !(box->lo_x <= box->hi_x); }

/// The boxes of a block's tiles: of all, and of parts.
typedef struct Boxes {
    TileBox all, parts[CLARAY_TILE_BLOCK * CLARAY_TILE_BLOCK];
    uint count;  // of parts
} Boxes;

static inline void add_part(Boxes* boxes, TileBox box) {
    if (!is_empty(&box)) boxes->parts[boxes->count++] = box;
}

/// The slices of a tile.
static inline void find_boxes_of_tile(global const TileBoxes* tile, Boxes* boxes) {
    boxes->all = tile->all, boxes->count = 0;
    for (uint i = 0; i < CLARAY_TILE_SLICES; ++i) add_part(boxes, tile->slices[i]);
}

/// The tiles of a block.
static inline void find_boxes_of_block(const TileGrid* tiles, global const TileBoxes* of_tiles, uint block, Boxes* boxes) {
    const uint x0 = block % tiles->block_columns * CLARAY_TILE_BLOCK, y0 = block / tiles->block_columns * CLARAY_TILE_BLOCK;
    TileBox all = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    boxes->count = 0;
    for (uint y = y0; y < min(y0 + CLARAY_TILE_BLOCK, tiles->rows); ++y)
        for (uint x = x0; x < min(x0 + CLARAY_TILE_BLOCK, tiles->columns); ++x) {
            const TileBox box = of_tiles[y * tiles->columns + x].all;
            all.lo_x = fmin(all.lo_x, box.lo_x), all.lo_y = fmin(all.lo_y, box.lo_y), all.lo_z = fmin(all.lo_z, box.lo_z);
            all.hi_x = fmax(all.hi_x, box.hi_x), all.hi_y = fmax(all.hi_y, box.hi_y), all.hi_z = fmax(all.hi_z, box.hi_z);
            add_part(boxes, box);
        }
    boxes->all = all;
}

#if CLARAY_CPU
#define ANY_OF(truths) movemask16(truths)
#else
#define ANY_OF(truths) (uint)(truths)
#endif

/// The lights from number `i` of a list on that may reach the surfaces: a bit for each.
static inline uint reaching_lights(global const float* bounds, uint stride, TileLights from, uint i, const Boxes* boxes) {
    const uint there = AT_ONCE == 1u ? 1u : (1u << min(AT_ONCE, from.count - i)) - 1u;
    LightBounds light;
    load_bounds(bounds, stride, from, i, 0, &light.x, &light.y, &light.z, &light.range);
    const uint near = ANY_OF(spheres_reach(&light, &boxes->all)) & there;
    if (near == 0) return 0;
    load_bounds(bounds, stride, from, i, 4, &light.axis_x, &light.axis_y, &light.axis_z, &light.cosine);
    const uint wanted = near & ANY_OF(cones_reach(&light, &boxes->all));
    uint found = 0;
    for (uint k = 0; k < boxes->count && found != wanted; ++k) {
        const Truths close = spheres_reach(&light, &boxes->parts[k]);
        if ((ANY_OF(close) & wanted) != 0) found |= wanted & ANY_OF(close & cones_reach(&light, &boxes->parts[k]));
    }
    return found;
}

/// Makes the lists of blocks (`of_blocks`) or of tiles, one per work-item on CPUs and one per group on GPUs. `block_lists` are read
/// for tiles only.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void list_lights(TileGrid tiles, uint of_blocks, global const float* bounds, global const TileBoxes* boxes, global const uint* block_lists,
                 global uint* lists) {
    const uint number = CLARAY_CPU ? get_global_id(0) : get_group_id(0);
    const uint room = of_blocks ? tiles.block_room : tiles.tile_room;
    if (CLARAY_CPU && number >= (of_blocks ? tiles.block_columns * tiles.block_rows : tiles.columns * tiles.rows)) return;
    const TileLights all = {0, tiles.lights};
    const TileLights from = of_blocks ? all : lights_of_block(&tiles, block_lists, block_of_tile(&tiles, number));
    Boxes around;
    if (of_blocks)
        find_boxes_of_block(&tiles, boxes, number, &around);
    else
        find_boxes_of_tile(&boxes[number], &around);
    const uint end = around.count == 0 ? 0 : from.count;
    global uint* list = lists + (size_t)number * (room + 1);
    uint count = 0;
#if CLARAY_CPU
    for (uint i = 0; i < end && count <= room; i += 16)
        for (uint left = reaching_lights(bounds, tiles.bounds_stride, from, i, &around); left != 0; left &= left - 1) {
            if (count < room) list[1 + count] = light_in_list(from, i + lowest_bit(left));
            ++count;
        }
    list[0] = count <= room ? count : CLARAY_ALL_LIGHTS;
#else
    // A bit for each of 32 lights per item, then prefix sums: one round serves many lights, since rounds wait at barriers.
    local uint words[GROUP_SIZE], kept[GROUP_SIZE];
    const uint item = get_local_id(0);
    for (uint begin = 0; begin < end; begin += 32 * GROUP_SIZE) {
        words[item] = 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        const uint most = min(end, begin + 32 * GROUP_SIZE);
        for (uint i = begin + item; i < most; i += GROUP_SIZE)
            if (reaching_lights(bounds, tiles.bounds_stride, from, i, &around) != 0)
                atomic_or(&words[(i - begin) / 32], 1u << (i - begin) % 32);
        barrier(CLK_LOCAL_MEM_FENCE);
        kept[item] = popcount(words[item]);
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint step = 1; step < GROUP_SIZE; step *= 2) {  // inclusive prefix sums
            const uint before = item >= step ? kept[item - step] : 0;
            barrier(CLK_LOCAL_MEM_FENCE);
            kept[item] += before;
            barrier(CLK_LOCAL_MEM_FENCE);
        }
        uint at = count + kept[item] - popcount(words[item]);
        for (uint left = words[item]; left != 0; left &= left - 1, ++at)
            if (at < room) list[1 + at] = light_in_list(from, begin + 32 * item + lowest_bit(left));
        count += kept[GROUP_SIZE - 1];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (item == 0) list[0] = count <= room ? count : CLARAY_ALL_LIGHTS;
#endif
}
