// The best tree, built from the root down: each node is split at the least cost by the surface area heuristic, between triangles or
// by a plane through them; then a triangle on both sides has a reference for each part (Stich, Friedrich and Dietrich 2009,
// "Spatial Splits in Bounding Volume Hierarchies"). All nodes of a level are split at once, one work-group each. The tree is the
// same on all devices, because references keep their order wherever the order matters.
#include "bvh/sbvh/sbvh.clh"
#include "compute/group_sum.clh"

#ifndef GROUP
#define GROUP 64
#endif
#include "bvh/sbvh/bins.clh"
#include "bvh/sbvh/clip_triangle.clh"

/// If the children overlap by less than this fraction of the root's area, splits through triangles are not tried (as Stich et al.).
#define LEAST_OVERLAP 1e-5f
/// Triangles per group of count_references and place_references.
#define TILE 2048u

// ---- references of all triangles, in their order ------------------------------------------------------------------------

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

/// One group: turns tile_sums into prefix sums.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void scan_tiles(global uint* tile_sums, uint tiles) {
    local uint scratch[GROUP];
    const uint item = get_local_id(0), run = (tiles + GROUP - 1) / GROUP;
    const uint begin = min(item * run, tiles), end = min(begin + run, tiles);
    uint sum = 0, total;
    for (uint i = begin; i < end; ++i) sum += tile_sums[i];
    uint prefix = group_exclusive_sum(sum, scratch, &total);
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
        const uint place = group_exclusive_sum(valid ? 1 : 0, scratch, &total);
        if (valid) save_reference(references, first + place, box_of(triangle), i);
        first += total;
    }
}

/// Writes the root's task, if there is anything to split.
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

// ---- splitting a node ---------------------------------------------------------------------------------------------------

#define BY_CENTROID 0u  // at the border of a bin of doubled centroids
#define BY_PLANE 1u     // through triangles
#define BY_PLACE 2u     // half of the references each, in their order

typedef struct Split {
    uint kind, axis, bin;
    float cost;
} Split;

/// Keeps the candidate of the best axis; of equal ones that of the lowest axis.
static inline void choose_axis(Split* split, uint kind, local const Candidate* candidates) {
    for (uint axis = 0; axis < 3; ++axis)
        if (candidates[axis].cost < split->cost) {
            split->kind = kind, split->axis = axis, split->bin = candidates[axis].bin;
            split->cost = candidates[axis].cost;
        }
}

/// Adds a reference, part by part, to the bins of planes that it spans.
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

/// The parts of a reference on both sides; a box is empty if there is none.
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

/// One side of a split node: returns its child reference, and appends the remaining work to a queue.
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

/// Local memory of a group that splits a node.
typedef struct Scratch {
    uint bin_boxes[3 * BINS * BOX_WORDS], bin_begin[3 * BINS], bin_end[3 * BINS];
    uint bounds[2][BOX_WORDS], sides[2][BOX_WORDS], sums[GROUP];
    Candidate candidates[3];
    Split chosen;
    uint wants_planes;
} Scratch;

static inline Bins bins_of(local Scratch* scratch) {
    const Bins bins = {scratch->bin_boxes, scratch->bin_begin, scratch->bin_end};
    return bins;
}

/// A node's bins.
typedef struct Grid {
    Slabs centroids[3], planes[3];  // along the references' doubled centroids, and across the node's box
    float over_area;                // 1 / the area of the node's box
} Grid;

static inline void make_axes(Slabs* slabs, Box box) {
    slabs[0] = make_slabs(box.lo.x, box.hi.x);
    slabs[1] = make_slabs(box.lo.y, box.hi.y);
    slabs[2] = make_slabs(box.lo.z, box.hi.z);
}

/// Clears the bins, too.
static inline Grid lay_grid(SplitTask task, global const float4* from, local Scratch* scratch) {
    const uint item = get_local_id(0);
    if (item < 2) clear_box(scratch->bounds[item]);
    clear_bins(bins_of(scratch));
    barrier(CLK_LOCAL_MEM_FENCE);
    Box box = empty_box(), centroids = empty_box();
    for (uint i = item; i < task.count; i += GROUP) {
        const Reference reference = load_reference(from, task.at + i);
        const float3 centroid = reference.box.lo + reference.box.hi;
        box = box_union(box, reference.box);
        centroids.lo = fmin(centroids.lo, centroid), centroids.hi = fmax(centroids.hi, centroid);
    }
    if (item < task.count) {
        grow_box(scratch->bounds[0], box);
        grow_box(scratch->bounds[1], centroids);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    box = grown_box(scratch->bounds[0]), centroids = grown_box(scratch->bounds[1]);
    Grid grid;
    make_axes(grid.centroids, centroids);
    make_axes(grid.planes, box);
    const float area = half_area(box);
    grid.over_area = area > 1e-30f && area < 1e30f ? strict_reciprocal(area) : 1.0f;
    return grid;
}

/// Fills the bins of centroids.
static inline void bin_centroids(SplitTask task, global const float4* from, const Grid* grid, Bins bins) {
    for (uint i = get_local_id(0); i < task.count; i += GROUP) {
        const Box b = load_reference(from, task.at + i).box;
        for (uint axis = 0; axis < 3; ++axis) {
            if (!(grid->centroids[axis].scale > 0.0f)) continue;
            const uint bin = axis * BINS + slab_of(grid->centroids[axis], component(b.lo, axis) + component(b.hi, axis));
            grow_box(bins.boxes + bin * BOX_WORDS, b);
            atomic_inc(&bins.begin[bin]);
            atomic_inc(&bins.end[bin]);
        }
    }
}

/// Half the area in which the sides of a split between triangles overlap.
static inline float shared_area_of(Split split, Bins bins) {
    if (split.kind != BY_CENTROID) return INFINITY;
    const Box overlap = box_intersection(box_of_bins(bins, split.axis, 0, split.bin + 1),
                                         box_of_bins(bins, split.axis, split.bin + 1, BINS));
    return box_empty(overlap) ? 0.0f : half_area(overlap);
}

/// Finds the best split between triangles, and whether one through triangles is worth a search.
static inline void split_between(SplitTask task, global const float4* from, const Grid* grid, global const uint* bound_keys,
                                 local Scratch* scratch) {
    const uint item = get_local_id(0);
    const Bins bins = bins_of(scratch);
    bin_centroids(task, from, grid, bins);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < 3) scratch->candidates[item] = best_border(bins, item, grid->over_area, task.count, task.count);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
        Split split = {BY_PLACE, 0, 0, INFINITY};
        if (task.depth < HALVING_DEPTH) choose_axis(&split, BY_CENTROID, scratch->candidates);
        const Box root = {(float3)(float_from_key(bound_keys[0]), float_from_key(bound_keys[1]), float_from_key(bound_keys[2])),
                          (float3)(float_from_key(bound_keys[3]), float_from_key(bound_keys[4]), float_from_key(bound_keys[5]))};
        scratch->chosen = split;
        scratch->wants_planes = task.depth < HALVING_DEPTH && task.capacity > task.count &&
                                shared_area_of(split, bins) > LEAST_OVERLAP * 0.25f * half_area(root);  // of doubled coordinates
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

/// Takes the best split through triangles if it is better.
static inline void split_through(SplitTask task, global const float4* from, const Grid* grid, global const float* positions,
                                 global const uint* indices, local Scratch* scratch) {
    const uint item = get_local_id(0);
    const Bins bins = bins_of(scratch);
    clear_bins(bins);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < task.count; i += GROUP)
        bin_parts(bins, grid->planes, load_reference(from, task.at + i), positions, indices);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < 3) scratch->candidates[item] = best_border(bins, item, grid->over_area, task.count, task.capacity);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
        Split split = scratch->chosen;
        choose_axis(&split, BY_PLANE, scratch->candidates);
        scratch->chosen = split;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

/// Moves the references: those of the left side to the beginning of the node's places and upwards, those of the right side to the
/// end and downwards. Returns their counts; their boxes are in `scratch->sides`.
static inline uint2 part_references(SplitTask task, Split split, const Grid* grid, global const float4* from, global float4* to,
                                    global const float* positions, global const uint* indices, local Scratch* scratch) {
    const uint item = get_local_id(0);
    uint2 counts = (uint2)(0);
    if (item < 2) clear_box(scratch->sides[item]);
    barrier(CLK_LOCAL_MEM_FENCE);
    Box left_box = empty_box(), right_box = empty_box();
    for (uint begin = 0; begin < task.count; begin += GROUP) {
        const uint i = begin + item;
        Box left = empty_box(), right = left;
        Reference reference;
        if (i < task.count) {
            reference = load_reference(from, task.at + i);
            divide(split, grid->centroids, grid->planes, reference, i < task.count / 2, positions, indices, &left, &right);
        }
        const bool to_left = !box_empty(left), to_right = !box_empty(right);
        uint total;
        const uint before = group_exclusive_sum((to_left ? 1 : 0) + (to_right ? 0x10000 : 0), scratch->sums, &total);
        if (to_left) {
            save_reference(to, task.begin + counts.x + (before & 0xffff), left, reference.primitive);
            left_box = box_union(left_box, left);
        }
        if (to_right) {
            save_reference(to, task.begin + task.capacity - 1 - counts.y - (before >> 16), right, reference.primitive);
            right_box = box_union(right_box, right);
        }
        counts += (uint2)(total & 0xffff, total >> 16);
    }
    if (!box_empty(left_box)) grow_box(scratch->sides[0], left_box);
    if (!box_empty(right_box)) grow_box(scratch->sides[1], right_box);
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    return counts;
}

/// One group per task. The references go from one buffer to the other.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void split_nodes(global const SplitTask* tasks, global SplitTask* large, global SplitTask* medium, global SplitTask* small,
                 global const float4* from, global float4* to, global const float* positions, global const uint* indices,
                 global const uint* bound_keys, global BvhNode* nodes, global LeafTriangle* leaves,
                 volatile global uint* counters) {
    local Scratch scratch;
    const SplitTask task = tasks[get_group_id(0)];
    const Grid grid = lay_grid(task, from, &scratch);
    split_between(task, from, &grid, bound_keys, &scratch);
    if (scratch.wants_planes) split_through(task, from, &grid, positions, indices, &scratch);

    Split split = scratch.chosen;
    uint2 counts = (uint2)(0);
    // A loop, because PoCL 3.1 crashes on two calls with barriers.
    for (uint attempt = 0; attempt < 2 && (counts.x == 0 || counts.y == 0); ++attempt) {
        if (attempt == 1) split.kind = BY_PLACE;  // roundings left one side empty
        counts = part_references(task, split, &grid, from, to, positions, indices, &scratch);
    }
    if (get_local_id(0) != 0) return;

    // Free places are divided in proportion to the counts.
    const uint used = counts.x + counts.y, free_places = task.capacity - used;
    const uint left_free = (uint)((ulong)free_places * counts.x / used);
    SplitTask left = {task.begin, counts.x + left_free, task.begin, 0, 0, task.depth + 1};
    SplitTask right = {task.begin + left.capacity, task.capacity - left.capacity, 0, 0, 0, task.depth + 1};
    right.at = task.begin + task.capacity - counts.y;
    const uint first_node = atomic_add(&counters[NODES], (counts.x > 1 ? 1 : 0) + (counts.y > 1 ? 1 : 0));
    const uint nodes_of[2] = {first_node, first_node + (counts.x > 1 ? 1 : 0)};
    global SplitTask* queues[3] = {large, medium, small};
    const Box boxes[2] = {grown_box(scratch.sides[0]), grown_box(scratch.sides[1])};
    const uint level = task.depth + 1;
    const uint child0 = place_child(boxes[0], left, counts.x, nodes_of[0], to, leaves, queues, counters, level);
    const uint child1 = place_child(boxes[1], right, counts.y, nodes_of[1], to, leaves, queues, counters, level);
    global BvhNode* node = &nodes[task.node];
    store_child_box(node, 0, boxes[0]);
    store_child_box(node, 1, boxes[1]);
    node->child0 = child0;
    node->child1 = child1;
    if (!is_leaf(child0)) nodes[child0].parent = task.node;
    if (!is_leaf(child1)) nodes[child1].parent = task.node;
}

/// Writes the header of the tree of references.
kernel void finish_splitting(global const LeafTriangle* leaves, global BvhHeader* header, global const uint* counters) {
    if (get_global_id(0) != 0) return;
    if (counters[LEAVES] == 1) store_header_box(header, box_of(leaf_triangle(&leaves[0])));
    header->inner_nodes = counters[NODES];
    header->valid = counters[LEAVES];
    header->root = counters[NODES] != 0 ? 0 : counters[LEAVES] != 0 ? CLARAY_LEAF : CLARAY_NO_CHILD;
}
