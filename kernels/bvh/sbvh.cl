// The best tree, built from the root down: each node is split at the least cost by the surface area heuristic, between triangles or
// by a plane through them; then a triangle on both sides has a reference for each part (Stich, Friedrich and Dietrich 2009,
// "Spatial Splits in Bounding Volume Hierarchies"). All nodes of a level are split at once, one work-group each, or several if a
// node has many references (sbvh_large.cl). The tree is the same on all devices, because no choice depends on the references'
// order.
#ifndef GROUP
#define GROUP 64
#endif
#include "bvh/sbvh/split.clh"

/// Triangles per group of place_references.
#define TILE 2048u

/// First kernel of a build.
kernel void begin_placing(global uint* root_extent, global uint* counters, uint counter_count, uint chunk_size) {
    const uint i = get_global_id(0);
    if (i < counter_count) counters[i] = i == CHUNK_SIZE ? chunk_size : 0;
    if (i < EXTENT_WORDS) root_extent[i] = is_minimum(i) ? 0xffffffffu : 0;
}

/// Makes references of all valid triangles.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void place_references(global const float* positions, global const uint* indices, uint count, global float4* references,
                      volatile global uint* root_extent, volatile global uint* counters) {
    local uint extent_words[EXTENT_WORDS] __attribute__((aligned(16)));
    local uint valid, place, first;
    const uint begin = get_group_id(0) * TILE, end = min(begin + TILE, count);
    if (ITEM == 0) valid = place = 0;
    clear_extents(extent_words, 1);
    GROUP_BARRIER();
    uint mine = 0;
    for (uint i = begin + ITEM; i < end; i += GROUP) mine += triangle_valid(load_triangle(positions, indices, i)) ? 1 : 0;
    group_count(&valid, mine);
    GROUP_BARRIER();
    if (ITEM == 0) first = valid == 0 ? 0 : atomic_add(&counters[PLACED], valid);
    GROUP_BARRIER();
    Extent extent = no_extent();
    for (uint tile = begin; tile < end; tile += GROUP) {
        const uint i = tile + ITEM;
        Triangle triangle;
        bool is_valid = false;
        if (i < end) {
            triangle = load_triangle(positions, indices, i);
            is_valid = triangle_valid(triangle);
        }
        const uint to = first + group_place(&place, is_valid);
        if (!is_valid) continue;
        save_reference(references, to, box_of(triangle), i);
        extend(&extent, box_of(triangle), i);
    }
    add_extent(extent_words, extent);
    GROUP_BARRIER();
    publish_extents(root_extent, extent_words, 1);
}

/// Writes the root's task, if there is anything to split.
kernel void begin_splitting(uint capacity, global const float4* references, global const uint* root_extent,
                            global LeafTriangle* leaves, global BvhNode* nodes, global WideTask* large, global WideTask* medium,
                            global SplitTask* small, volatile global uint* counters) {
    const uint count = counters[PLACED];
    if (get_global_id(0) != 0 || count == 0) return;
    const SplitTask root = {0, capacity, 0, count, 0, 0};
    const Queues queues = {large, medium, small, counters};
    if (count > 1) counters[NODES] = 1;
    (void)place_child(queues, root, load_extent(root_extent), CLARAY_NO_CHILD, references, nodes, leaves);
}

/// Local memory of a group that splits a node.
typedef struct Scratch {
    uint bins[LOCAL_WORDS_OF_BINS], sides[2 * EXTENT_WORDS], counts[2];
    Candidate candidates[3];
    Split chosen;
    uint wants_planes;
} Scratch;

/// Searches the best split between triangles, then through triangles if that may pay.
static inline void choose_split(SplitTask task, Extent extent, const Grid* grid, global const float4* from,
                                global const float* positions, global const uint* indices, global const uint* root_extent,
                                local Scratch* scratch) {
    const Bins bins = bins_in(scratch->bins);
    const uint end = task.at + task.count;
    // A loop, because PoCL 3.1 crashes on two calls of best_borders.
    for (uint by_planes = 0; by_planes < 2 && (by_planes == 0 || scratch->wants_planes); ++by_planes) {
        clear_bins(bins);
        GROUP_BARRIER();
        if (by_planes) bin_parts(bins, grid, from, task.at, end, positions, indices);
        else bin_centroids(bins, grid, from, task.at, end);
        GROUP_BARRIER();
        best_borders(bins, by_planes ? bins.end : bins.begin, grid->over_area, task.count,
                     by_planes ? task.capacity : task.count, scratch->candidates);
        GROUP_BARRIER();
        if (ITEM == 0) {
            Split split = scratch->chosen;
            if (by_planes) choose_axis(&split, BY_PLANE, scratch->candidates);
            else scratch->wants_planes = split_between(task, extent, scratch->candidates,
                                                       half_area(box_of_extent(load_extent(root_extent))), &split);
            scratch->chosen = split;
        }
        GROUP_BARRIER();
    }
}

/// One group per task. The references go from one buffer to the other.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void split_nodes(global const WideTask* tasks, global WideTask* large, global WideTask* medium, global SplitTask* small,
                 global const float4* from, global float4* to, global const float* positions, global const uint* indices,
                 global const uint* root_extent, global BvhNode* nodes, global LeafTriangle* leaves,
                 volatile global uint* counters) {
    local Scratch scratch __attribute__((aligned(64)));
    const SplitTask task = tasks[get_group_id(0)].task;
    const Extent extent = load_extent(tasks[get_group_id(0)].extent);
    const Grid grid = lay_grid(extent);
    choose_split(task, extent, &grid, from, positions, indices, root_extent, &scratch);

    Split split = scratch.chosen;
    uint2 counts = (uint2)(0);
    // A loop, because PoCL 3.1 crashes on two calls with barriers.
    for (uint attempt = 0; attempt < 2 && (counts.x == 0 || counts.y == 0); ++attempt) {
        if (attempt == 1) split = split_by_number(extent);  // roundings left one side empty
        if (ITEM == 0) scratch.counts[0] = scratch.counts[1] = 0;
        clear_extents(scratch.sides, 2);
        GROUP_BARRIER();
        part_references(task, split, &grid, from, to, task.at, task.at + task.count, positions, indices, scratch.counts,
                        scratch.sides);
        GROUP_BARRIER();
        counts = (uint2)(scratch.counts[0], scratch.counts[1]);
    }
    if (ITEM != 0) return;
    const Queues queues = {large, medium, small, counters};
    finish_node(queues, task, counts.x, counts.y, local_extent(scratch.sides), local_extent(scratch.sides + EXTENT_WORDS), to,
                nodes, leaves);
}

/// Writes the header of the tree of references.
kernel void finish_splitting(global const LeafTriangle* leaves, global BvhHeader* header, global const uint* counters) {
    if (get_global_id(0) != 0) return;
    if (counters[LEAVES] == 1) store_header_box(header, box_of(leaf_triangle(&leaves[0])));
    header->inner_nodes = counters[NODES];
    header->valid = counters[LEAVES];
    header->root = counters[NODES] != 0 ? 0 : counters[LEAVES] != 0 ? CLARAY_LEAF : CLARAY_NO_CHILD;
}
