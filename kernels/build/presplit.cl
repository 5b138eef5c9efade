// Large triangles become several references before the tree is built (early split clipping, Ernst and Greiner 2007), as
// many as their priority deserves within a budget, split where the Morton grid splits space first (Karras and Aila 2013,
// "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", section 4).
#include "build/morton_codes.clh"
#include "build/references.clh"

/// The least priority that is worth a split: below it triangles are no larger than their neighbours, and splitting them
/// costs more than it saves.
#ifndef LEAST_PRIORITY
#define LEAST_PRIORITY 1.0f
#endif

/// Scales that are tried at once in a search for the one that spends the budget.
#define TRIALS 16
#define GROUP 256
/// Triangles that a group of count_splits and place_splits looks after.
#define TILE 2048

/// What the kernels below hand on to each other.
typedef struct SplitPlan {
    uint extra;         // references beyond one a triangle, in all
    uint sums[TRIALS];  // splits by scale
    float scale;        // splits of a triangle = floor(scale * priority)
    uint done;
    uint references;    // in the tree
} SplitPlan;

/// The grid that bounds.cl laid, over doubled coordinates.
typedef struct Grid {
    float3 origin, scale, cell;  // cell: the reciprocal of the scale; 0 where the scene has no extent
} Grid;

static inline float cell_size(float scale) { return scale > 0.0f ? strict_reciprocal(scale) : 0.0f; }

static inline Grid load_grid(global const BvhHeader* header) {
    Grid grid;
    grid.origin = (float3)(header->lox, header->loy, header->loz);
    grid.scale = (float3)(header->scale_x, header->scale_y, header->scale_z);
    grid.cell = (float3)(cell_size(grid.scale.x), cell_size(grid.scale.y), cell_size(grid.scale.z));
    return grid;
}

/// The cell of a doubled coordinate.
static inline uint cell_of(float doubled, float origin, float scale) { return grid_cell(fmax(doubled - origin, 0.0f), scale); }

/// Where cell `index` begins, in plain coordinates.
static inline float plane_at(const Grid* grid, uint axis, uint index) {
    return 0.5f * (component(grid->origin, axis) + (float)index * component(grid->cell, axis));
}

typedef struct SplitPlane {
    uint axis;
    uint level;  // 0 halves the whole scene, every further one halves the cells; AXIS_BITS: no plane
    float position;
} SplitPlane;

/// The plane of the axis that cuts the box's inside and halves the largest cells.
static inline SplitPlane plane_on_axis(const Grid* grid, Box box, uint axis) {
    SplitPlane none = {axis, AXIS_BITS, 0.0f};
    const float lo = component(box.lo, axis), hi = component(box.hi, axis);
    const float origin = component(grid->origin, axis), scale = component(grid->scale, axis);
    if (!(lo < hi) || !(scale > 0.0f)) return none;
    uint first = cell_of(lo + lo, origin, scale), last = cell_of(hi + hi, origin, scale);
    if (first < last && plane_at(grid, axis, last) >= hi) --last;
    if (first < last && plane_at(grid, axis, first + 1) <= lo) ++first;
    if (first >= last) return none;
    const uint bit = 31u - clz(first ^ last);
    const SplitPlane plane = {axis, AXIS_BITS - 1 - bit, plane_at(grid, axis, (last >> bit) << bit)};
    return plane.position > lo && plane.position < hi ? plane : none;
}

/// Of the three axes' planes the one that halves the largest cells, and of equals the one across the box's longest side.
static inline SplitPlane split_plane(const Grid* grid, Box box) {
    SplitPlane best = plane_on_axis(grid, box, 0);
    for (uint axis = 1; axis < 3; ++axis) {
        const SplitPlane plane = plane_on_axis(grid, box, axis);
        const float3 extent = box.hi - box.lo;
        if (plane.level < best.level ||
            (plane.level == best.level && component(extent, axis) > component(extent, best.axis)))
            best = plane;
    }
    return best;
}

// ---- how many splits ------------------------------------------------------------------------------------------------

/// Half the area of the boxes round infinitely many parts of the triangle: of its projections onto the three planes.
static inline float ideal_area(Triangle t) {
    const float3 a = t.v1 - t.v0, b = t.v2 - t.v0;
    return 0.5f * (fabs(a.y * b.z - a.z * b.y) + fabs(a.z * b.x - a.x * b.z) + fabs(a.x * b.y - a.y * b.x));
}

/// `keys` as compute_bounds left them. Priorities are relative to the average triangle's share of the scene's area, so
/// that neither the scene's size nor its number of triangles matters.
kernel void split_priorities(global const float* positions, global const uint* indices, uint count,
                             global const BvhHeader* header, global const uint* keys, global float* priorities,
                             global SplitPlan* plan) {
    const uint i = get_global_id(0);
    if (i == 0) {
        plan->extra = plan->done = 0;
        plan->references = 0;
        plan->scale = 1.0f / LEAST_PRIORITY;
        for (uint k = 0; k < TRIALS; ++k) plan->sums[k] = 0;
    }
    if (i >= count) return;
    const Triangle triangle = load_triangle(positions, indices, i);
    float priority = 0.0f;
    if (triangle_valid(triangle)) {
        const Grid grid = load_grid(header);
        const Box box = box_of(triangle);
        const SplitPlane plane = split_plane(&grid, box);
        const float3 extent = 0.5f * ((float3)(float_from_key(keys[3]), float_from_key(keys[4]), float_from_key(keys[5])) -
                                      grid.origin);
        const float scene = extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
        const float excess = half_area(box) - ideal_area(triangle);
        if (plane.level < AXIS_BITS && excess > 0.0f && scene > 1e-30f && scene < 1e30f) {
            const float importance = as_float((127u - plane.level) << 23);  // 2^-level
            priority = strict_cube_root(excess * strict_reciprocal(scene) * (float)header->valid * importance);
        }
    }
    priorities[i] = priority;
}

static inline uint splits_of(float priority, float scale, uint limit) { return (uint)fmin(priority * scale, (float)limit); }

/// Scale number k of a pass: halves in the first, sixteenths between two halves in the second.
static inline float trial_scale(float scale, uint k, uint pass) {
    if (pass == 0) return scale * as_float((127u - k) << 23);
    return scale * (1.0f + (float)k / (float)TRIALS);
}

/// Adds the splits that every trial scale would give to plan->sums.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void count_splits(global const float* priorities, uint count, uint limit, uint pass, volatile global SplitPlan* plan) {
    local uint group_sums[TRIALS];
    const uint item = get_local_id(0);
    if (item < TRIALS) group_sums[item] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const float scale = plan->scale;
    uint sums[TRIALS];
    for (uint k = 0; k < TRIALS; ++k) sums[k] = 0;
    for (uint j = item; j < TILE; j += GROUP) {
        const uint i = get_group_id(0) * TILE + j;
        const float priority = i < count ? priorities[i] : 0.0f;
        if (priority * scale * 2.0f < 1.0f) continue;
        for (uint k = 0; k < TRIALS; ++k) sums[k] += splits_of(priority, trial_scale(scale, k, pass), limit);
    }
    for (uint k = 0; k < TRIALS; ++k)
        if (sums[k] != 0) atomic_add(&group_sums[k], sums[k]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < TRIALS && group_sums[item] != 0) atomic_add(&plan->sums[item], group_sums[item]);
}

/// Keeps the largest scale within the budget.
kernel void choose_scale(global SplitPlan* plan, uint budget, uint pass) {
    if (get_global_id(0) != 0) return;
    uint chosen = pass == 0 ? TRIALS - 1 : 0;
    for (uint j = 0; j < TRIALS; ++j) {
        const uint k = pass == 0 ? j : TRIALS - 1 - j;  // from the largest scale on
        if (plan->sums[k] > budget) continue;
        chosen = k;
        break;
    }
    const bool enough = plan->sums[chosen] <= budget && !plan->done;
    if (!plan->done) plan->scale = enough ? trial_scale(plan->scale, chosen, pass) : 0.0f;
    if ((pass == 0 && chosen == 0) || !enough) plan->done = 1;  // the budget does not matter, or nothing fits it
    for (uint k = 0; k < TRIALS; ++k) plan->sums[k] = 0;
}

// ---- where the parts go: prefix sums in three steps -----------------------------------------------------------------

kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void sum_splits(global const float* priorities, uint count, uint limit, global const SplitPlan* plan,
                global uint* tile_sums) {
    local uint sum;
    const uint item = get_local_id(0);
    if (item == 0) sum = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint mine = 0;
    for (uint j = item; j < TILE; j += GROUP) {
        const uint i = get_group_id(0) * TILE + j;
        if (i < count) mine += splits_of(priorities[i], plan->scale, limit);
    }
    if (mine != 0) atomic_add(&sum, mine);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) tile_sums[get_group_id(0)] = sum;
}

/// The exclusive prefix sum of one value an item; the group's total in `total`.
static inline uint group_prefix(uint value, local uint* scratch, uint* total) {
    const uint item = get_local_id(0);
    scratch[item] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint step = 1; step < GROUP; step *= 2) {
        const uint before = item >= step ? scratch[item - step] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        scratch[item] += before;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    *total = scratch[GROUP - 1];
    const uint prefix = scratch[item] - value;
    barrier(CLK_LOCAL_MEM_FENCE);
    return prefix;
}

/// One group: tile_sums become prefix sums, plan->extra their total.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void scan_splits(global uint* tile_sums, uint tiles, global SplitPlan* plan) {
    local uint scratch[GROUP];
    const uint item = get_local_id(0), run = (tiles + GROUP - 1) / GROUP;
    const uint begin = min(item * run, tiles), end = min(begin + run, tiles);
    uint sum = 0, total;
    for (uint i = begin; i < end; ++i) sum += tile_sums[i];
    uint prefix = group_prefix(sum, scratch, &total);
    for (uint i = begin; i < end; ++i) {
        const uint value = tile_sums[i];
        tile_sums[i] = prefix;
        prefix += value;
    }
    if (item == 0) plan->extra = total;
}

// ---- splitting ------------------------------------------------------------------------------------------------------

static inline bool box_empty(Box box) { return !(box.lo.x <= box.hi.x && box.lo.y <= box.hi.y && box.lo.z <= box.hi.z); }

static inline Box box_with(Box box, float3 point) {
    const Box grown = {fmin(box.lo, point), fmax(box.hi, point)};
    return grown;
}

static inline Box box_intersection(Box a, Box b) {
    const Box box = {fmax(a.lo, b.lo), fmin(a.hi, b.hi)};
    return box;
}

/// A box that holds the point in which edge ab crosses the plane strictly between its ends. With u = 2^-24 the parameter
/// p is off by at most 8 u of itself, so a coordinate by 9 u of the edge's extent and 2 u of its size: the pad is
/// larger, and the edge's own extent bounds the rest.
static inline Box edge_crossing(float3 a, float3 b, uint axis, float plane) {
    const float from = component(a, axis), to = component(b, axis);
    const float length = fabs(to - from);
    const float p = length > 1e-30f ? fabs(plane - from) * strict_reciprocal(length) : 0.5f;
    const float3 edge = b - a;
    const float slack = length > 1e-30f ? 9.5367432e-7f : 1.0f;  // 16 u, or the whole edge
    const float3 pad = slack * fabs(edge) + 2.3841858e-7f * fmax(fabs(a), fabs(b)) + (float3)(1e-36f);
    const float3 point = a + edge * p;
    const Box near = {point - pad, point + pad}, all_of_it = {fmin(a, b), fmax(a, b)};
    return box_intersection(near, all_of_it);
}

/// The parts of a reference on either side of a plane, each in a box as small as the triangle's edges allow. Every point of
/// the triangle in `box` is in one of the two.
static inline void split_reference(Triangle t, Box box, SplitPlane plane, Box* left, Box* right) {
    const Box nothing = {(float3)(INFINITY), (float3)(-INFINITY)};
    Box below = nothing, above = nothing;
    const float3 corner[3] = {t.v0, t.v1, t.v2};
    for (uint i = 0; i < 3; ++i) {
        const float3 a = corner[i], b = corner[i == 2 ? 0 : i + 1];
        const float from = component(a, plane.axis), to = component(b, plane.axis);
        if (from <= plane.position) below = box_with(below, a);
        if (from >= plane.position) above = box_with(above, a);
        if (fmin(from, to) < plane.position && plane.position < fmax(from, to)) {
            const Box crossing = edge_crossing(a, b, plane.axis, plane.position);
            below = box_union(below, crossing);
            above = box_union(above, crossing);
        }
    }
    below.hi = with_component(below.hi, plane.axis, fmin(component(below.hi, plane.axis), plane.position));
    above.lo = with_component(above.lo, plane.axis, fmax(component(above.lo, plane.axis), plane.position));
    *left = box_intersection(below, box);
    *right = box_intersection(above, box);
}

typedef struct Output {
    global LeafTriangle* references;
    global Code* codes;
    uint primitive, first, extra;  // the first reference is at the triangle's own place, the others from `extra` on
    uint count;
} Output;

static inline void emit_reference(Output* output, const Grid* grid, Box box) {
    const uint at = output->count++ == 0 ? output->first : output->extra++;
    store_reference(&output->references[at], box, output->primitive);
    const float3 centre = box.lo + box.hi;
    output->codes[at] = MORTON(cell_of(centre.x, grid->origin.x, grid->scale.x),
                               cell_of(centre.y, grid->origin.y, grid->scale.y),
                               cell_of(centre.z, grid->origin.z, grid->scale.z));
}

typedef struct Part {
    Box box;
    uint splits;
} Part;

/// Splits a triangle's box `splits` times, the halves by turns in proportion to their longest sides. The larger share
/// waits on the stack, which so never holds more than log2(splits) parts.
static inline void split_triangle(Triangle triangle, const Grid* grid, uint splits, Output* output) {
    Part stack[16], part = {box_of(triangle), splits};
    uint depth = 0;
    while (true) {
        const SplitPlane plane = split_plane(grid, part.box);
        if (part.splits == 0 || plane.level == AXIS_BITS) {
            emit_reference(output, grid, part.box);
            if (depth == 0) return;
            part = stack[--depth];
            continue;
        }
        Part left, right;
        split_reference(triangle, part.box, plane, &left.box, &right.box);
        const bool no_left = box_empty(left.box), no_right = box_empty(right.box);
        if (no_left && no_right) {  // boxes are not tight: nothing of the triangle is in this one
            if (depth == 0) return;
            part = stack[--depth];
            continue;
        }
        if (no_left || no_right) {  // all of this part is on one side, whose box is smaller
            part.box = no_left ? right.box : left.box;
            continue;
        }
        const float of_left = largest_extent(left.box), of_both = of_left + largest_extent(right.box);
        const uint rest = part.splits - 1;
        const float share = of_both > 1e-30f ? of_left * strict_reciprocal(of_both) : 0.5f;
        left.splits = min((uint)((float)rest * share + 0.5f), rest);
        right.splits = rest - left.splits;
        const bool left_first = left.splits <= right.splits;
        stack[depth++] = left_first ? right : left;
        part = left_first ? left : right;
    }
}

/// Writes `count` + plan->extra references and their codes; places that are left over, and triangles that are not valid,
/// get a code above all others. `header->valid` becomes the number of references.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void place_splits(global const float* positions, global const uint* indices, uint count, uint limit,
                  global const BvhHeader* header, global const float* priorities, volatile global SplitPlan* plan,
                  global const uint* tile_sums, global LeafTriangle* references, global Code* codes) {
    local uint scratch[GROUP];
    const Grid grid = load_grid(header);
    uint base = count + tile_sums[get_group_id(0)], written = 0;
    for (uint j = 0; j < TILE; j += GROUP) {
        const uint i = get_group_id(0) * TILE + j + get_local_id(0);
        const uint splits = i < count ? splits_of(priorities[i], plan->scale, limit) : 0;
        uint total;
        const uint extra = base + group_prefix(splits, scratch, &total);
        base += total;
        if (i >= count) continue;
        codes[i] = ~(Code)0;
        Output output = {references, codes, i, i, extra, 0};
        const Triangle triangle = load_triangle(positions, indices, i);
        if (triangle_valid(triangle)) split_triangle(triangle, &grid, splits, &output);
        written += output.count;
        for (uint at = output.extra; at < extra + splits; ++at) codes[at] = ~(Code)0;
    }
    if (written != 0) atomic_add(&plan->references, written);
}

/// The references in the order of the sorted codes, and a cluster of each, as begin_hploc does for triangles.
kernel void gather_references(global const LeafTriangle* references, global const uint* order,
                              global const SplitPlan* plan, global LeafTriangle* leaves, global uint* clusters,
                              global BvhHeader* header) {
    const uint leaf = get_global_id(0), valid = plan->references;
    if (leaf == 0) {
        header->valid = valid;
        header->inner_nodes = max(valid, 1u) - 1;
        if (valid == 1) {
            store_header_box(header, box_of(leaf_triangle(&references[order[0]])));
            header->root = CLARAY_LEAF;
            header->height = 0;
        }
    }
    if (leaf >= valid) return;
    leaves[leaf] = references[order[leaf]];
    clusters[leaf] = CLARAY_LEAF | leaf;
}
