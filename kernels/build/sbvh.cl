// The best tree: from the root down, every node is split where the surface area heuristic is least, between triangles or
// through them by a plane that gives a triangle on both sides a reference for each part (Stich, Friedrich and Dietrich 2009,
// "Spatial Splits in Bounding Volume Hierarchies"). All nodes of a level are split at once, a work-group each; the
// order of a node's references never matters but where it is kept, so the tree is the same on every device.
#include "build/references.clh"

#ifndef GROUP
#define GROUP 64
#endif
#define BINS 32u
/// Nodes of so many references are not split through triangles any more, and one group finishes all that is below them.
#define SMALL 32u
/// From this depth on nodes are halved, so that no tree is higher than the stack of a traversal.
#define HALVING_DEPTH 48u
/// Children that share less than this part of the root's area are not worth a split through triangles (Stich et al. use the
/// same).
#define LEAST_OVERLAP 1e-5f
/// Triangles that a group of count_references and place_references looks after.
#define TILE 2048u

/// A box and whose it is, in two rows of 16 bytes: lo and the primitive, hi.
typedef struct Reference {
    Box box;
    uint primitive;
} Reference;

static inline Reference load_reference(global const float4* rows, uint i) {
    const float4 lo = rows[2 * i], hi = rows[2 * i + 1];
    const Reference reference = {{lo.xyz, hi.xyz}, as_uint(lo.w)};
    return reference;
}

static inline void save_reference(global float4* rows, uint i, Box box, uint primitive) {
    rows[2 * i] = (float4)(box.lo, as_float(primitive));
    rows[2 * i + 1] = (float4)(box.hi, 0.0f);
}

/// A node to be split: `count` references from `at` on, within `capacity` places from `begin` on that are its own.
typedef struct SplitTask {
    uint begin, capacity, at, count;
    uint node;
    uint depth;  // odd: the references are in the second buffer
} SplitTask;

// What `counters` counts: nodes, leaves, small tasks, then tasks by level for large and for medium nodes.
#define NODES 0
#define LEAVES 1
#define SMALL_TASKS 2
#define TASKS_OF_LEVEL(level, size) (3 + 2 * (level) + (size))
#define LARGE 4096u

// ---- references of all triangles, in their order ------------------------------------------------------------------------

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

kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void count_references(global const float* positions, global const uint* indices, uint count, global uint* tile_sums) {
    local uint sum;
    if (get_local_id(0) == 0) sum = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint begin = get_group_id(0) * TILE, end = min(begin + TILE, count);
    uint valid = 0;
    for (uint i = begin + get_local_id(0); i < end; i += GROUP)
        valid += triangle_valid(load_triangle(positions, indices, i)) ? 1 : 0;
    if (valid != 0) atomic_add(&sum, valid);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) tile_sums[get_group_id(0)] = sum;
}

/// One group: tile_sums become prefix sums.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void scan_tiles(global uint* tile_sums, uint tiles) {
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
}

kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void place_references(global const float* positions, global const uint* indices, uint count,
                      global const uint* tile_sums, global float4* references) {
    local uint scratch[GROUP];
    const uint begin = get_group_id(0) * TILE;
    uint first = tile_sums[get_group_id(0)];
    for (uint j = 0; j < TILE; j += GROUP) {
        const uint i = begin + j + get_local_id(0);
        Triangle triangle;
        bool valid = false;
        if (i < count) {
            triangle = load_triangle(positions, indices, i);
            valid = triangle_valid(triangle);
        }
        uint total;
        const uint place = group_prefix(valid ? 1 : 0, scratch, &total);
        if (valid) save_reference(references, first + place, box_of(triangle), i);
        first += total;
    }
}

/// The root's task, if there is anything to split.
kernel void begin_splitting(global const BvhHeader* header, uint capacity, global const float4* references,
                            global LeafTriangle* leaves, global BvhNode* nodes, global SplitTask* large,
                            global SplitTask* medium, global SplitTask* small, global uint* counters) {
    const uint count = header->valid;
    if (get_global_id(0) != 0 || count == 0) return;
    if (count == 1) {
        const Reference reference = load_reference(references, 0);
        store_reference(&leaves[0], reference.box, reference.primitive);
        counters[LEAVES] = 1;
        return;
    }
    const SplitTask root = {0, capacity, 0, count, 0, 0};
    nodes[0].parent = CLARAY_NO_CHILD;
    counters[NODES] = 1;
    if (count > LARGE) {
        large[0] = root;
        counters[TASKS_OF_LEVEL(0, 0)] = 1;
    } else if (count > SMALL) {
        medium[0] = root;
        counters[TASKS_OF_LEVEL(0, 1)] = 1;
    } else {
        small[0] = root;
        counters[SMALL_TASKS] = 1;
    }
}

// ---- boxes that a group grows together ----------------------------------------------------------------------------------

#define BOX_WORDS 6

static inline void clear_box(volatile local uint* words) {
    for (uint k = 0; k < 3; ++k) words[k] = 0xffffffffu, words[3 + k] = 0;
}

/// Looks before it writes: nearly all boxes lie within what others have added.
static inline void grow_box(volatile local uint* words, Box box) {
    const uint lo[3] = {float_key(box.lo.x), float_key(box.lo.y), float_key(box.lo.z)};
    const uint hi[3] = {float_key(box.hi.x), float_key(box.hi.y), float_key(box.hi.z)};
    for (uint k = 0; k < 3; ++k) {
        if (lo[k] < words[k]) atomic_min(&words[k], lo[k]);
        if (hi[k] > words[3 + k]) atomic_max(&words[3 + k], hi[k]);
    }
}

static inline Box empty_box(void) {
    const Box box = {(float3)(INFINITY), (float3)(-INFINITY)};
    return box;
}

/// An empty box where nothing was added.
static inline Box grown_box(volatile local const uint* words) {
    if (words[0] > words[3]) return empty_box();
    const Box box = {(float3)(float_from_key(words[0]), float_from_key(words[1]), float_from_key(words[2])),
                     (float3)(float_from_key(words[3]), float_from_key(words[4]), float_from_key(words[5]))};
    return box;
}

// ---- parts of triangles -------------------------------------------------------------------------------------------------

typedef struct SplitPlane {
    uint axis;
    float position;
} SplitPlane;

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

// ---- bins ---------------------------------------------------------------------------------------------------------------

/// BINS slabs of equal width from `lo` on; scale 0: the axis has no extent.
typedef struct Slabs {
    float lo, scale, width;
} Slabs;

static inline Slabs make_slabs(float lo, float hi) {
    const float extent = hi - lo;
    Slabs slabs = {lo, 0.0f, 0.0f};
    if (extent > 1e-30f) {
        slabs.scale = (float)BINS * strict_reciprocal(extent);
        slabs.width = extent * (1.0f / (float)BINS);
    }
    return slabs;
}

static inline uint slab_of(Slabs slabs, float x) {
    return (uint)clamp((int)((x - slabs.lo) * slabs.scale), 0, (int)BINS - 1);
}

static inline float plane_after(Slabs slabs, uint bin) { return slabs.lo + slabs.width * (float)(bin + 1); }

/// What is counted in a bin: references that begin there and that end there, which is the same between triangles.
typedef struct Bins {
    volatile local uint *boxes, *begin, *end;
} Bins;

static inline void clear_bins(Bins bins) {
    for (uint i = get_local_id(0); i < 3 * BINS; i += GROUP) {
        clear_box(bins.boxes + i * BOX_WORDS);
        bins.begin[i] = bins.end[i] = 0;
    }
}

typedef struct Candidate {
    float cost;  // areas times references of both sides, over the node's area; INFINITY: none
    uint bin;    // the last one on the left
} Candidate;

/// The best border between bins of one axis, by the two sweeps of binned building (Wald 2007). Splits that would need more
/// than `limit` references, or leave all on both sides, don't count.
static inline Candidate best_border(Bins bins, uint axis, float over_area, uint count, uint limit) {
    float right_cost[BINS];
    uint right_count[BINS];
    Box box = empty_box();
    uint references = 0;
    for (uint i = BINS - 1; i > 0; --i) {
        const uint bin = axis * BINS + i;
        box = box_union(box, grown_box(bins.boxes + bin * BOX_WORDS));
        references += bins.end[bin];
        right_count[i] = references;
        right_cost[i] = references == 0 ? 0.0f : half_area(box) * over_area * (float)references;
    }
    Candidate best = {INFINITY, 0};
    box = empty_box();
    references = 0;
    for (uint i = 0; i + 1 < BINS; ++i) {
        const uint bin = axis * BINS + i;
        box = box_union(box, grown_box(bins.boxes + bin * BOX_WORDS));
        references += bins.begin[bin];
        const uint right = right_count[i + 1];
        if (references == 0 || right == 0 || references + right > limit || (references == count && right == count)) continue;
        const float cost = half_area(box) * over_area * (float)references + right_cost[i + 1];
        if (cost < best.cost) best.cost = cost, best.bin = i;
    }
    return best;
}

static inline Box box_of_bins(Bins bins, uint axis, uint begin, uint end) {
    Box box = empty_box();
    for (uint i = begin; i < end; ++i) box = box_union(box, grown_box(bins.boxes + (axis * BINS + i) * BOX_WORDS));
    return box;
}

// ---- splitting a node ---------------------------------------------------------------------------------------------------

#define BY_CENTROID 0u  // at the border of a bin of doubled centroids
#define BY_PLANE 1u     // through triangles
#define BY_PLACE 2u     // half of them each, as they lie

typedef struct Split {
    uint kind, axis, bin;
    float cost;
} Split;

/// Keeps the best axis's candidate, the lowest axis of equals.
static inline void choose_axis(Split* split, uint kind, local const Candidate* candidates) {
    for (uint axis = 0; axis < 3; ++axis)
        if (candidates[axis].cost < split->cost) {
            split->kind = kind, split->axis = axis, split->bin = candidates[axis].bin;
            split->cost = candidates[axis].cost;
        }
}

/// Adds a reference to the bins of planes that it spans, part by part.
static inline void bin_parts(Bins bins, const Slabs* slabs, Reference reference, global const float* positions,
                             global const uint* indices) {
    for (uint axis = 0; axis < 3; ++axis) {
        if (!(slabs[axis].scale > 0.0f)) continue;
        const uint first = slab_of(slabs[axis], component(reference.box.lo, axis));
        const uint last = slab_of(slabs[axis], component(reference.box.hi, axis));
        atomic_inc(&bins.begin[axis * BINS + first]);
        atomic_inc(&bins.end[axis * BINS + last]);
        Box rest = reference.box;
        if (first < last) {
            const Triangle triangle = load_triangle(positions, indices, reference.primitive);
            for (uint i = first; i < last && !box_empty(rest); ++i) {
                const SplitPlane plane = {axis, plane_after(slabs[axis], i)};
                Box part, beyond;
                split_reference(triangle, rest, plane, &part, &beyond);
                if (!box_empty(part)) grow_box(bins.boxes + (axis * BINS + i) * BOX_WORDS, part);
                rest = beyond;
            }
        }
        if (!box_empty(rest)) grow_box(bins.boxes + (axis * BINS + last) * BOX_WORDS, rest);
    }
}

/// The parts of a reference on both sides; an empty box where there is none.
static inline void divide(Split split, const Slabs* centroids, const Slabs* planes, Reference reference, bool first_half,
                          global const float* positions, global const uint* indices, Box* left, Box* right) {
    *left = *right = empty_box();
    bool is_left = first_half, is_right = !first_half;
    if (split.kind == BY_CENTROID) {
        const float centroid = component(reference.box.lo, split.axis) + component(reference.box.hi, split.axis);
        is_left = slab_of(centroids[split.axis], centroid) <= split.bin;
        is_right = !is_left;
    } else if (split.kind == BY_PLANE) {
        is_left = slab_of(planes[split.axis], component(reference.box.lo, split.axis)) <= split.bin;
        is_right = slab_of(planes[split.axis], component(reference.box.hi, split.axis)) > split.bin;
        if (is_left && is_right) {
            const SplitPlane plane = {split.axis, plane_after(planes[split.axis], split.bin)};
            split_reference(load_triangle(positions, indices, reference.primitive), reference.box, plane, left, right);
            return;
        }
    }
    if (is_left) *left = reference.box;
    if (is_right) *right = reference.box;
}

/// One side of a split node: what its reference in the node must be, and the work that is left.
static inline uint place_child(Box box, SplitTask task, uint count, uint node, global const float4* references,
                               global LeafTriangle* leaves, global SplitTask* queues[3], volatile global uint* counters,
                               uint level) {
    if (count == 1) {
        const uint slot = atomic_inc(&counters[LEAVES]);
        store_reference(&leaves[slot], box, load_reference(references, task.at).primitive);
        return CLARAY_LEAF | slot;
    }
    const uint size = count > LARGE ? 0 : count > SMALL ? 1 : 2;
    const uint place = atomic_inc(&counters[size == 2 ? SMALL_TASKS : TASKS_OF_LEVEL(level, size)]);
    task.count = count;
    task.node = node;
    queues[size][place] = task;
    return node;
}

/// A group a task. The references go from one buffer to the other: those of the left side from the beginning of the node's
/// places upwards, those of the right side from the end downwards.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void split_nodes(global const SplitTask* tasks, global SplitTask* large, global SplitTask* medium, global SplitTask* small,
                 global const float4* from, global float4* to, global const float* positions, global const uint* indices,
                 global const uint* bound_keys, global BvhNode* nodes, global LeafTriangle* leaves,
                 volatile global uint* counters) {
    local uint bin_boxes[3 * BINS * BOX_WORDS], bin_begin[3 * BINS], bin_end[3 * BINS];
    local uint bounds[2][BOX_WORDS], sides[2][BOX_WORDS], scratch[GROUP];
    local Candidate candidates[3];
    local Split chosen;
    local uint wants_planes;
    const Bins bins = {bin_boxes, bin_begin, bin_end};
    const uint item = get_local_id(0);
    const SplitTask task = tasks[get_group_id(0)];

    // The node's box, and that of its references' doubled centroids.
    if (item < 2) clear_box(bounds[item]);
    clear_bins(bins);
    barrier(CLK_LOCAL_MEM_FENCE);
    Box box = empty_box(), centroids = empty_box();
    for (uint i = item; i < task.count; i += GROUP) {
        const Reference reference = load_reference(from, task.at + i);
        const float3 centroid = reference.box.lo + reference.box.hi;
        box = box_union(box, reference.box);
        centroids.lo = fmin(centroids.lo, centroid), centroids.hi = fmax(centroids.hi, centroid);
    }
    if (item < task.count) {
        grow_box(bounds[0], box);
        grow_box(bounds[1], centroids);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    box = grown_box(bounds[0]), centroids = grown_box(bounds[1]);
    const Slabs of_centroids[3] = {make_slabs(centroids.lo.x, centroids.hi.x), make_slabs(centroids.lo.y, centroids.hi.y),
                                   make_slabs(centroids.lo.z, centroids.hi.z)};
    const Slabs of_planes[3] = {make_slabs(box.lo.x, box.hi.x), make_slabs(box.lo.y, box.hi.y),
                                make_slabs(box.lo.z, box.hi.z)};
    const float area = half_area(box);
    const float over_area = area > 1e-30f && area < 1e30f ? strict_reciprocal(area) : 1.0f;

    // Between triangles.
    for (uint i = item; i < task.count; i += GROUP) {
        const Box b = load_reference(from, task.at + i).box;
        for (uint axis = 0; axis < 3; ++axis) {
            if (!(of_centroids[axis].scale > 0.0f)) continue;
            const uint bin = axis * BINS + slab_of(of_centroids[axis], component(b.lo, axis) + component(b.hi, axis));
            grow_box(bins.boxes + bin * BOX_WORDS, b);
            atomic_inc(&bins.begin[bin]);
            atomic_inc(&bins.end[bin]);
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < 3) candidates[item] = best_border(bins, item, over_area, task.count, task.count);
    if (item == 0) wants_planes = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
        Split split = {BY_PLACE, 0, 0, INFINITY};
        if (task.depth < HALVING_DEPTH) choose_axis(&split, BY_CENTROID, candidates);
        float shared_area = INFINITY;
        if (split.kind == BY_CENTROID) {
            const Box overlap = box_intersection(box_of_bins(bins, split.axis, 0, split.bin + 1),
                                                 box_of_bins(bins, split.axis, split.bin + 1, BINS));
            shared_area = box_empty(overlap) ? 0.0f : half_area(overlap);
        }
        const Box root = {(float3)(float_from_key(bound_keys[0]), float_from_key(bound_keys[1]), float_from_key(bound_keys[2])),
                          (float3)(float_from_key(bound_keys[3]), float_from_key(bound_keys[4]), float_from_key(bound_keys[5]))};
        chosen = split;
        wants_planes = task.depth < HALVING_DEPTH && task.capacity > task.count &&
                       shared_area > LEAST_OVERLAP * 0.25f * half_area(root);  // whose coordinates are doubled
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    // Through triangles.
    if (wants_planes) {
        clear_bins(bins);
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint i = item; i < task.count; i += GROUP)
            bin_parts(bins, of_planes, load_reference(from, task.at + i), positions, indices);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item < 3) candidates[item] = best_border(bins, item, over_area, task.count, task.capacity);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item == 0) {
            Split split = chosen;
            choose_axis(&split, BY_PLANE, candidates);
            chosen = split;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }

    // To both sides; where roundings leave one of them empty, by halves.
    Split split = chosen;
    uint left_count = 0, right_count = 0;
    for (uint attempt = 0; attempt < 2 && (left_count == 0 || right_count == 0); ++attempt) {
        if (attempt == 1) split.kind = BY_PLACE;
        left_count = right_count = 0;
        if (item < 2) clear_box(sides[item]);
        barrier(CLK_LOCAL_MEM_FENCE);
        Box left_box = empty_box(), right_box = empty_box();
        for (uint begin = 0; begin < task.count; begin += GROUP) {
            const uint i = begin + item;
            Box left = empty_box(), right = left;
            Reference reference;
            if (i < task.count) {
                reference = load_reference(from, task.at + i);
                divide(split, of_centroids, of_planes, reference, i < task.count / 2, positions, indices, &left, &right);
            }
            const bool to_left = !box_empty(left), to_right = !box_empty(right);
            uint total;
            const uint before = group_prefix((to_left ? 1 : 0) + (to_right ? 0x10000 : 0), scratch, &total);
            if (to_left) {
                save_reference(to, task.begin + left_count + (before & 0xffff), left, reference.primitive);
                left_box = box_union(left_box, left);
            }
            if (to_right) {
                save_reference(to, task.begin + task.capacity - 1 - right_count - (before >> 16), right,
                               reference.primitive);
                right_box = box_union(right_box, right);
            }
            left_count += total & 0xffff;
            right_count += total >> 16;
        }
        if (!box_empty(left_box)) grow_box(sides[0], left_box);
        if (!box_empty(right_box)) grow_box(sides[1], right_box);
        barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    }
    if (item != 0) return;

    // What is free is shared out in proportion.
    const uint used = left_count + right_count, free_places = task.capacity - used;
    const uint left_free = (uint)((ulong)free_places * left_count / used);
    SplitTask left = {task.begin, left_count + left_free, task.begin, 0, 0, task.depth + 1};
    SplitTask right = {task.begin + left.capacity, task.capacity - left.capacity, 0, 0, 0, task.depth + 1};
    right.at = task.begin + task.capacity - right_count;
    const uint first_node = atomic_add(&counters[NODES], (left_count > 1 ? 1 : 0) + (right_count > 1 ? 1 : 0));
    const uint nodes_of[2] = {first_node, first_node + (left_count > 1 ? 1 : 0)};
    global SplitTask* queues[3] = {large, medium, small};
    const Box boxes[2] = {grown_box(sides[0]), grown_box(sides[1])};
    const uint level = task.depth + 1;
    const uint child0 = place_child(boxes[0], left, left_count, nodes_of[0], to, leaves, queues, counters, level);
    const uint child1 = place_child(boxes[1], right, right_count, nodes_of[1], to, leaves, queues, counters, level);
    global BvhNode* node = &nodes[task.node];
    store_child_box(node, 0, boxes[0]);
    store_child_box(node, 1, boxes[1]);
    node->child0 = child0;
    node->child1 = child1;
    if (!is_leaf(child0)) nodes[child0].parent = task.node;
    if (!is_leaf(child1)) nodes[child1].parent = task.node;
}

// ---- small nodes --------------------------------------------------------------------------------------------------------

/// References of a small node, as they are sorted into subtrees: rows of SMALL coordinates, lo.x lo.y lo.z hi.x hi.y hi.z.
typedef local const float* SmallBoxes;

static inline Box small_box(SmallBoxes rows, uint i) {
    const Box box = {(float3)(rows[i], rows[SMALL + i], rows[2 * SMALL + i]),
                     (float3)(rows[3 * SMALL + i], rows[4 * SMALL + i], rows[5 * SMALL + i])};
    return box;
}

static inline float doubled_centroid(SmallBoxes rows, uint axis, uint i) {
    return rows[axis * SMALL + i] + rows[(3 + axis) * SMALL + i];
}

static inline Box box_of_range(SmallBoxes rows, uint begin, uint end) {
    Box box = small_box(rows, begin);
    for (uint i = begin + 1; i < end; ++i) box = box_union(box, small_box(rows, i));
    return box;
}

/// A split behind the centroid of one reference, on one axis.
typedef struct SmallSplit {
    float cost, centroid;
    uint axis;
} SmallSplit;

/// The best of the splits behind reference i of a range, on all axes: references whose doubled centroid is not larger go left.
static inline SmallSplit split_behind(SmallBoxes rows, uint begin, uint end, uint i) {
    SmallSplit best = {INFINITY, 0.0f, 3};
    for (uint axis = 0; axis < 3; ++axis) {
        const float border = doubled_centroid(rows, axis, i);
        Box left = empty_box(), right = left;
        uint left_count = 0;
        for (uint j = begin; j < end; ++j) {
            const Box box = small_box(rows, j);
            if (doubled_centroid(rows, axis, j) <= border) {
                left = box_union(left, box);
                ++left_count;
            } else {
                right = box_union(right, box);
            }
        }
        const uint right_count = end - begin - left_count;
        if (right_count == 0) continue;
        const float cost = half_area(left) * (float)left_count + half_area(right) * (float)right_count;
        if (cost < best.cost) best.cost = cost, best.centroid = border, best.axis = axis;
    }
    return best;
}

static inline bool better(SmallSplit a, SmallSplit b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.axis != b.axis) return a.axis < b.axis;
    return a.centroid < b.centroid;
}

typedef struct SmallTask {
    uint begin, end, node, depth;
} SmallTask;

/// A group of SMALL items a task: all splits of a subtree, each the best of all.
kernel __attribute__((reqd_work_group_size(SMALL, 1, 1)))
void finish_subtrees(global const SplitTask* tasks, global const float4* even, global const float4* odd,
                     global BvhNode* nodes, global LeafTriangle* leaves, volatile global uint* counters) {
    local float rows[6 * SMALL], sorted_rows[6 * SMALL];
    local uint primitives[SMALL], sorted_primitives[SMALL];
    local SmallSplit splits[SMALL];
    local SmallTask stack[SMALL];
    local SmallSplit best;
    local uint goes_left[SMALL];
    const uint item = get_local_id(0);
    const SplitTask task = tasks[get_group_id(0)];
    if (item < task.count) {
        const Reference reference = load_reference(task.depth % 2 == 0 ? even : odd, task.at + item);
        for (uint axis = 0; axis < 3; ++axis) {
            rows[axis * SMALL + item] = component(reference.box.lo, axis);
            rows[(3 + axis) * SMALL + item] = component(reference.box.hi, axis);
        }
        primitives[item] = reference.primitive;
    }
    const SmallTask root = {0, task.count, task.node, task.depth};
    if (item == 0) stack[0] = root;
    uint depth = 1;
    barrier(CLK_LOCAL_MEM_FENCE);
    while (depth != 0) {
        const SmallTask current = stack[--depth];
        const uint count = current.end - current.begin, i = current.begin + item;
        const bool mine = item < count;
        if (mine) splits[item] = split_behind(rows, current.begin, current.end, i);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item == 0) {
            best = splits[0];
            for (uint k = 1; k < count; ++k)
                if (better(splits[k], best)) best = splits[k];
            if (current.depth >= HALVING_DEPTH) best.axis = 3;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        if (mine) {
            const uint axis = min(best.axis, 2u);
            goes_left[item] = best.axis == 3 ? item < count / 2 : doubled_centroid(rows, axis, i) <= best.centroid;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        uint left_count = 0, before = 0;
        for (uint k = 0; k < count; ++k) {
            if (k < item) before += goes_left[k];
            left_count += goes_left[k];
        }
        if (mine) {
            const uint place = current.begin + (goes_left[item] ? before : left_count + item - before);
            for (uint row = 0; row < 6; ++row) sorted_rows[row * SMALL + place] = rows[row * SMALL + i];
            sorted_primitives[place] = primitives[i];
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        if (mine) {
            for (uint row = 0; row < 6; ++row) rows[row * SMALL + i] = sorted_rows[row * SMALL + i];
            primitives[i] = sorted_primitives[i];
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        const uint inner = (left_count > 1 ? 1 : 0) + (count - left_count > 1 ? 1 : 0);
        if (item == 0) {
            const uint middle = current.begin + left_count;
            SmallTask sides[2] = {{current.begin, middle, 0, current.depth + 1}, {middle, current.end, 0, current.depth + 1}};
            uint place = depth, next = inner == 0 ? 0 : atomic_add(&counters[NODES], inner);
            global BvhNode* node = &nodes[current.node];
            uint children[2];
            for (uint side = 0; side < 2; ++side) {
                const Box box = box_of_range(rows, sides[side].begin, sides[side].end);
                store_child_box(node, side, box);
                if (sides[side].end - sides[side].begin == 1) {
                    const uint slot = atomic_inc(&counters[LEAVES]);
                    store_reference(&leaves[slot], box, primitives[sides[side].begin]);
                    children[side] = CLARAY_LEAF | slot;
                } else {
                    sides[side].node = children[side] = next++;
                    nodes[sides[side].node].parent = current.node;
                    stack[place++] = sides[side];
                }
            }
            node->child0 = children[0];
            node->child1 = children[1];
        }
        depth += inner;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

/// The header of the tree of references.
kernel void finish_splitting(global const LeafTriangle* leaves, global BvhHeader* header, global const uint* counters) {
    if (get_global_id(0) != 0) return;
    if (counters[LEAVES] == 1) store_header_box(header, box_of(leaf_triangle(&leaves[0])));
    header->inner_nodes = counters[NODES];
    header->valid = counters[LEAVES];
    header->root = counters[NODES] != 0 ? 0 : counters[LEAVES] != 0 ? CLARAY_LEAF : CLARAY_NO_CHILD;
}
