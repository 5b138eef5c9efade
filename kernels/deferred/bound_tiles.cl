// Boxes around the surfaces that tiles show. A box of points in space needs no shape of the camera's: lenses, motion and parallel rays
// are no special cases. Where a tile shows near and far surfaces, or a slanted one, most of its box is empty. Therefore the box is cut
// across its longest axis, and the surfaces in each slice have a box of their own (Harada 2012, "A 2.5D Culling for Forward+", has a bit
// for each interval of depth).
#include "deferred/tiles.clh"
#include "math/vector_sixteen.clh"
#include "shade/instance.clh"
#if CLARAY_CPU
#include "trace/packets/columns.clh"
#endif

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

typedef struct Box {
    float3 lo, hi;
} Box;

/// Slices of a box: those of which a coordinate is between multiples of a length.
typedef struct Slices {
    uint axis;
    float from, per_length;
} Slices;

static inline Slices slices_of(const Box* box) {
    const float3 size = box->hi - box->lo;
    const uint axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const float length = axis == 0 ? size.x : axis == 1 ? size.y : size.z;
    const Slices slices = {axis, axis == 0 ? box->lo.x : axis == 1 ? box->lo.y : box->lo.z,
                           length > 0.0f ? (float)CLARAY_TILE_SLICES / length : 0.0f};
    return slices;
}

static inline void store_box(global TileBox* to, Box box) {
    const TileBox found = {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
    *to = found;
}

#if CLARAY_CPU
typedef struct Boxes16 {
    Vectors lo, hi;
} Boxes16;

static inline Boxes16 no_boxes16(void) {
    const float16 most = (float16)(INFINITY);
    const Boxes16 boxes = {{most, most, most}, {-most, -most, -most}};
    return boxes;
}

static inline void grow_boxes16(Boxes16* boxes, Vectors points, int16 which) {
    const float16 most = (float16)(INFINITY);
    boxes->lo.x = min(boxes->lo.x, select(most, points.x, which)), boxes->hi.x = max(boxes->hi.x, select(-most, points.x, which));
    boxes->lo.y = min(boxes->lo.y, select(most, points.y, which)), boxes->hi.y = max(boxes->hi.y, select(-most, points.y, which));
    boxes->lo.z = min(boxes->lo.z, select(most, points.z, which)), boxes->hi.z = max(boxes->hi.z, select(-most, points.z, which));
}

static inline Box around16(const Boxes16* boxes) {
    const Box box = {(float3)(least16(boxes->lo.x), least16(boxes->lo.y), least16(boxes->lo.z)),
                     (float3)(most16(boxes->hi.x), most16(boxes->hi.y), most16(boxes->hi.z))};
    return box;
}

/// met_point of at most sixteen paths. Returns the lanes that met something.
static inline int16 met_points16(global const Ray* rays, global const SceneHit* hits, uint first, uint end, Vectors* points) {
    uint paths[16], primitives[16];
    float ts[16];
    for (uint i = 0; i < 16; ++i) {
        paths[i] = min(first + i, end - 1);
        ts[i] = hits[paths[i]].t, primitives[i] = hits[paths[i]].primitive;
    }
    Columns16 from, along;
    load_rays16(rays, paths, &from, &along);
    const float16 t = vload16(0, ts);
    points->x = fma(t, along.x, from.x), points->y = fma(t, along.y, from.y), points->z = fma(t, along.z, from.z);
    return vload16(0, primitives) != CLARAY_MISS;
}

/// One work-item per tile.
kernel void bound_tiles(Step step, TileGrid tiles, global const Ray* rays, global const SceneHit* hits, global TileBoxes* boxes) {
    const uint tile = get_global_id(0);
    if (tile >= tiles.columns * tiles.rows) return;
    Boxes16 all16 = no_boxes16(), parts16[CLARAY_TILE_SLICES];
    Vectors points;
    for (uint row = 0; row < CLARAY_TILE; ++row) {
        const PathRange paths = paths_of_row(&step, &tiles, tile, row);
        for (uint path = paths.first; path < paths.end; path += 16) {
            const int16 met = met_points16(rays, hits, path, paths.end, &points);
            grow_boxes16(&all16, points, met);
        }
    }
    const Box all = around16(&all16);
    const Slices slices = slices_of(&all);
    for (uint i = 0; i < CLARAY_TILE_SLICES; ++i) parts16[i] = no_boxes16();
    for (uint row = 0; row < CLARAY_TILE; ++row) {
        const PathRange paths = paths_of_row(&step, &tiles, tile, row);
        for (uint path = paths.first; path < paths.end; path += 16) {
            const int16 met = met_points16(rays, hits, path, paths.end, &points);
            const float16 at = slices.axis == 0 ? points.x : slices.axis == 1 ? points.y : points.z;
            const int16 slice = convert_int16(clamp((at - slices.from) * slices.per_length, 0.0f, (float)(CLARAY_TILE_SLICES - 1)));
            for (uint i = 0; i < CLARAY_TILE_SLICES; ++i) {
                const int16 here = met & (slice == (int)i);
                if (movemask16(here) != 0) grow_boxes16(&parts16[i], points, here);
            }
        }
    }
    store_box(&boxes[tile].all, all);
    for (uint i = 0; i < CLARAY_TILE_SLICES; ++i) store_box(&boxes[tile].slices[i], around16(&parts16[i]));
}
#else
static inline Box no_box(void) {
    const Box box = {(float3)(INFINITY), (float3)(-INFINITY)};
    return box;
}

static inline uint slice_of(const Slices* slices, float3 point) {
    const float at = slices->axis == 0 ? point.x : slices->axis == 1 ? point.y : point.z;
    return (uint)clamp((at - slices->from) * slices->per_length, 0.0f, (float)(CLARAY_TILE_SLICES - 1));
}

/// Grows boxes by every `step`-th path from `first` on: `boxes[0]` by all, or without `slices` null each slice's by those in it.
static inline void bound_paths(PathRange paths, uint first, uint step, global const Ray* rays, global const SceneHit* hits,
                               const Slices* slices, Box* boxes) {
    for (uint path = paths.first + first; path < paths.end; path += step) {
        if (hits[path].primitive == CLARAY_MISS) continue;
        const float3 point = met_point(rays[path], hits[path].t);
        Box* box = &boxes[slices ? slice_of(slices, point) : 0];
        box->lo = fmin(box->lo, point), box->hi = fmax(box->hi, point);
    }
}

/// The box around those of all items of the group.
static inline Box box_of_group(Box own, local float3* los, local float3* his) {
    const uint item = get_local_id(0);
    los[item] = own.lo, his[item] = own.hi;
    for (uint half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item < half_size) los[item] = fmin(los[item], los[item + half_size]), his[item] = fmax(his[item], his[item + half_size]);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const Box box = {los[0], his[0]};
    barrier(CLK_LOCAL_MEM_FENCE);  // before the memory is used again
    return box;
}

/// One work-group per tile, with the same number of items for each row.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void bound_tiles(Step step, TileGrid tiles, global const Ray* rays, global const SceneHit* hits, global TileBoxes* boxes) {
    local float3 los[GROUP_SIZE], his[GROUP_SIZE];
    const uint tile = get_group_id(0), item = get_local_id(0), share = GROUP_SIZE / CLARAY_TILE;
    const PathRange paths = paths_of_row(&step, &tiles, tile, item / share);
    Box own = no_box(), parts[CLARAY_TILE_SLICES];
    bound_paths(paths, item % share, share, rays, hits, 0, &own);
    const Box all = box_of_group(own, los, his);
    for (uint i = 0; i < CLARAY_TILE_SLICES; ++i) parts[i] = no_box();
    const Slices slices = slices_of(&all);
    bound_paths(paths, item % share, share, rays, hits, &slices, parts);
    if (item == 0) store_box(&boxes[tile].all, all);
    for (uint i = 0; i < CLARAY_TILE_SLICES; ++i) {
        const Box slice = box_of_group(parts[i], los, his);
        if (item == 0) store_box(&boxes[tile].slices[i], slice);
    }
}
#endif
