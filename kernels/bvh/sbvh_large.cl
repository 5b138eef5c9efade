// The upper levels of the best tree: several groups split a node of more than LARGE references. Each has a chunk of them, bins it
// in local memory, and adds its bins to those of the node; later it moves its chunk to both sides.
#ifndef GROUP
#define GROUP 256
#endif
#include "bvh/sbvh/split.clh"

/// What the chunks of a node share while it is split.
typedef struct LargeNode {
    uint counts[4];  // of references that go left and right; the last two after a split by number
    uint sides[2 * EXTENT_WORDS];
    Split split;
    uint wants_planes;
} LargeNode;

/// Where a chunk is: its node, and the number among the node's chunks; and its places on both sides of the node.
typedef struct Chunk {
    uint node, number, left, right;
} Chunk;

static inline uint chunk_begin(SplitTask task, Chunk chunk, uint chunk_size) { return task.at + chunk.number * chunk_size; }
static inline uint chunk_end(SplitTask task, Chunk chunk, uint chunk_size) {
    return min(chunk_begin(task, chunk, chunk_size) + chunk_size, task.at + task.count);
}

/// One group per node: divides it into chunks, and clears what they share.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void begin_large(global const WideTask* tasks, global LargeNode* states, global uint* node_bins, global Chunk* chunks,
                 uint chunk_size, volatile global uint* counters) {
    const uint node = get_group_id(0);
    const SplitTask task = tasks[node].task;
    for (uint i = ITEM; i < chunks_of(task.count, chunk_size); i += GROUP) {
        global Chunk* chunk = &chunks[atomic_inc(&counters[NUMBERED_CHUNKS(task.depth)])];
        chunk->node = node, chunk->number = i;
    }
    global uint* bins = node_bins + (size_t)node * WORDS_OF_BINS;
    for (uint i = ITEM; i < WORDS_OF_BINS; i += GROUP) bins[i] = cleared_bin_key(i);
    global LargeNode* state = &states[node];
    for (uint i = ITEM; i < 2 * EXTENT_WORDS; i += GROUP) state->sides[i] = is_minimum(i) ? 0xffffffffu : 0;
    for (uint i = ITEM; i < 4; i += GROUP) state->counts[i] = 0;
}

/// The group adds its bins to those of the node.
static inline void publish_bins(volatile global uint* to, local const uint* from) {
    for (uint i = ITEM; i < WORDS_OF_BINS; i += GROUP) {
        const uint key = bin_key(i, from[i]);
        if (key == cleared_bin_key(i)) continue;
        if (!is_word_of_box(i)) atomic_add(&to[i], key);
        else if (is_word_of_minima(i)) atomic_min(&to[i], key);
        else atomic_max(&to[i], key);
    }
}

/// One group per chunk: fills the bins of centroids, or of planes.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void bin_large(global const WideTask* tasks, global const LargeNode* states, global uint* node_bins, global const Chunk* chunks,
               uint chunk_size, uint by_planes, global const float4* from, global const float* positions,
               global const uint* indices) {
    local uint words[LOCAL_WORDS_OF_BINS] __attribute__((aligned(64)));
    const Chunk chunk = chunks[get_group_id(0)];
    const SplitTask task = tasks[chunk.node].task;
    const Grid grid = lay_grid(load_extent(tasks[chunk.node].extent));
    const Bins bins = bins_in(words);
    const bool wanted = !by_planes || states[chunk.node].wants_planes;
    const uint begin = chunk_begin(task, chunk, chunk_size), end = wanted ? chunk_end(task, chunk, chunk_size) : begin;
    clear_bins(bins);
    GROUP_BARRIER();
    if (by_planes) bin_parts(bins, &grid, from, begin, end, positions, indices);
    else bin_centroids(bins, &grid, from, begin, end);
    GROUP_BARRIER();
    publish_bins(node_bins + (size_t)chunk.node * WORDS_OF_BINS, words);
}

/// One group per node: chooses the best split between triangles and clears the bins, or the best one through triangles.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void choose_large(global const WideTask* tasks, global LargeNode* states, global uint* node_bins, global const uint* root_extent,
                  uint by_planes) {
    local uint words[LOCAL_WORDS_OF_BINS] __attribute__((aligned(64)));
    local Candidate candidates[3];
    const uint node = get_group_id(0);
    global LargeNode* state = &states[node];
    global uint* bins_of_node = node_bins + (size_t)node * WORDS_OF_BINS;
    for (uint i = ITEM; i < WORDS_OF_BINS; i += GROUP) {
        words[i] = bin_word(i, bins_of_node[i]);
        bins_of_node[i] = cleared_bin_key(i);
    }
    const SplitTask task = tasks[node].task;
    const Extent extent = load_extent(tasks[node].extent);
    const Grid grid = lay_grid(extent);
    const Bins bins = bins_in(words);
    GROUP_BARRIER();
    best_borders(bins, by_planes ? bins.end : bins.begin, grid.over_area, task.count, by_planes ? task.capacity : task.count,
                 candidates);
    GROUP_BARRIER();
    if (ITEM != 0) return;
    Split split = state->split;
    if (by_planes) choose_axis(&split, BY_PLANE, candidates);
    else state->wants_planes =
             split_between(task, extent, candidates, half_area(box_of_extent(load_extent(root_extent))), &split);
    state->split = split;
}

/// Counts the references of a chunk that go to each side, and reserves their places. `counts` is local and zero.
static inline void reserve_places(Split split, const Grid* grid, global const float4* from, uint begin, uint end,
                                  global const float* positions, global const uint* indices, local uint* counts,
                                  volatile global uint* node_counts, local uint* places) {
    uint mine[2] = {0, 0};
    for (uint i = begin + ITEM; i < end; i += GROUP) {
        Box left, right;
        divide(split, grid, load_reference(from, i), positions, indices, &left, &right);
        mine[0] += box_empty(left) ? 0 : 1;
        mine[1] += box_empty(right) ? 0 : 1;
    }
    for (uint side = 0; side < 2; ++side) group_count(&counts[side], mine[side]);
    GROUP_BARRIER();
    if (ITEM == 0)
        for (uint side = 0; side < 2; ++side)
            places[side] = counts[side] == 0 ? 0 : atomic_add(&node_counts[side], counts[side]);
    GROUP_BARRIER();
}

/// One group per chunk: reserves the places of its references on both sides.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void reserve_large(global const WideTask* tasks, global LargeNode* states, global Chunk* chunks, uint chunk_size,
                   global const float4* from, global const float* positions, global const uint* indices) {
    local uint counts[2], places[2];
    const Chunk chunk = chunks[get_group_id(0)];
    const SplitTask task = tasks[chunk.node].task;
    const Grid grid = lay_grid(load_extent(tasks[chunk.node].extent));
    if (ITEM == 0) counts[0] = counts[1] = 0;
    GROUP_BARRIER();
    reserve_places(states[chunk.node].split, &grid, from, chunk_begin(task, chunk, chunk_size), chunk_end(task, chunk, chunk_size),
                   positions, indices, counts, states[chunk.node].counts, places);
    if (ITEM == 0) chunks[get_group_id(0)].left = places[0], chunks[get_group_id(0)].right = places[1];
}

/// One group per chunk: moves its references to both sides, from one buffer to the other. If roundings left one side empty, the
/// node is split by number instead.
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1)))
void move_large(global const WideTask* tasks, global LargeNode* states, global const Chunk* chunks, uint chunk_size,
                global const float4* from, global float4* to, global const float* positions, global const uint* indices) {
    local uint places[2], counts[2];
    local uint sides[2 * EXTENT_WORDS] __attribute__((aligned(16)));
    const Chunk chunk = chunks[get_group_id(0)];
    global LargeNode* state = &states[chunk.node];
    const SplitTask task = tasks[chunk.node].task;
    const Extent extent = load_extent(tasks[chunk.node].extent);
    const Grid grid = lay_grid(extent);
    const uint begin = chunk_begin(task, chunk, chunk_size), end = chunk_end(task, chunk, chunk_size);
    const bool by_number = state->counts[0] == 0 || state->counts[1] == 0;
    Split split = state->split;
    if (by_number) split = split_by_number(extent);
    if (ITEM == 0) counts[0] = counts[1] = 0;
    clear_extents(sides, 2);
    GROUP_BARRIER();
    reserve_places(split, &grid, from, begin, by_number ? end : begin, positions, indices, counts, &state->counts[2], places);
    if (ITEM == 0 && !by_number) places[0] = chunk.left, places[1] = chunk.right;
    GROUP_BARRIER();
    part_references(task, split, &grid, from, to, begin, end, positions, indices, places, sides);
    GROUP_BARRIER();
    publish_extents(state->sides, sides, 2);
}

/// One item per node.
kernel void finish_large(global const WideTask* tasks, global const LargeNode* states, uint count, global WideTask* large,
                         global WideTask* medium, global SplitTask* small, global const float4* references, global BvhNode* nodes,
                         global LeafTriangle* leaves, volatile global uint* counters) {
    const uint node = get_global_id(0);
    if (node >= count) return;
    global const LargeNode* state = &states[node];
    const uint by_number = state->counts[0] == 0 || state->counts[1] == 0 ? 2 : 0;
    const Queues queues = {large, medium, small, counters};
    finish_node(queues, tasks[node].task, state->counts[by_number], state->counts[by_number + 1], load_extent(state->sides),
                load_extent(state->sides + EXTENT_WORDS), references, nodes, leaves);
}
