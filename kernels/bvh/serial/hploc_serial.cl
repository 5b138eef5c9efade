// The tree of hploc.cl by the serial schedule for CPUs. The clusters of all waiting subtrees on the stack form one list from left
// to right, so that a meeting works at the end of the list and nothing is read back from memory. Nodes are numbered in the order of
// creation, from the range's first leaf on.
#include "bvh/columns.clh"
#include "bvh/hploc.clh"
#include "bvh/serial/serial.clh"

/// The fourth lanes hold bits: the child in lo, height and count as in BvhNode in hi.
typedef struct Cluster {
    float4 lo, hi;
} Cluster;

typedef struct Waiting {
    uint first, left;  // leaf, and the level of the border before it
    uint begin;        // in the list
} Waiting;

typedef struct Stack {
    Cluster list[MAX_CLUSTERS * MAX_WAITING + 2 * MAX_CLUSTERS];
    Waiting waiting[MAX_WAITING];
    uint depth, outward;  // as in lbvh_serial.cl
    uint length;          // of the list
    uint node, node_end;  // the next one to be made, and where free numbers end
    // The next free numbers, for joining: those that the ranges did not use.
    uint range, ranges, valid;
    global const uint2* piece_counts;
} Stack;

static inline uint take_node(Stack* stack) {
    while (stack->node == stack->node_end) {
        const uint range = stack->range++;
        stack->node = range_begin(range, stack->ranges, stack->valid) + stack->piece_counts[range].y;
        stack->node_end = range_begin(range + 1, stack->ranges, stack->valid);
    }
    return stack->node++;
}

static inline Cluster merge_clusters(global BvhNode* nodes, Stack* stack, Cluster a, Cluster b) {
    Cluster merged = {lesser(a.lo, b.lo), greater(a.hi, b.hi)};
    const uint child0 = as_uint(a.lo.w), child1 = as_uint(b.lo.w), of_a = as_uint(a.hi.w), of_b = as_uint(b.hi.w);
    const uint count = min((of_a & CLARAY_COUNT_LIMIT) + (of_b & CLARAY_COUNT_LIMIT), CLARAY_COUNT_LIMIT);
    const Box box0 = {a.lo.xyz, a.hi.xyz}, box1 = {b.lo.xyz, b.hi.xyz};
    const uint leaf = joined_leaf(box0, child0, box1, child1);
    if (leaf != CLARAY_NO_CHILD) {
        merged.lo.w = as_float(leaf), merged.hi.w = as_float(count);
        return merged;
    }
    const uint index = take_node(stack);
    global BvhNode* node = &nodes[index];
    store_boxes(node, a.lo, a.hi, b.lo, b.hi);
    const uint height = min(1 + max(of_a >> 24, of_b >> 24), 255u);
    const uint height_count = (height << 24) | count;
    vstore4((uint4)(child0, child1, CLARAY_NO_CHILD, height_count), 3, (global uint*)node);
    if (!is_leaf(child0)) nodes[child0].parent = index;
    if (!is_leaf(child1)) nodes[child1].parent = index;
    merged.lo.w = as_float(index), merged.hi.w = as_float(height_count);
    return merged;
}

// ---- the nearest neighbours of up to 32 clusters, eight at a time ----------------------------------------------------

#define MOST (2 * MAX_CLUSTERS)
#define LANES 8u  // not less than SEARCH_RADIUS

typedef struct Search {
    float lox[MOST + 2 * LANES], loy[MOST + 2 * LANES], loz[MOST + 2 * LANES];  // with room for sentinels
    float hix[MOST + 2 * LANES], hiy[MOST + 2 * LANES], hiz[MOST + 2 * LANES];
    uint key[SEARCH_RADIUS][SEARCH_RADIUS + MOST];  // of i and i + 1 + row, at SEARCH_RADIUS + i
    uint least[MOST];                               // key of a cluster and the nearest to it
} Search;

/// Clusters i .. i + 7 of the list.
static inline void load_clusters(Search* search, const Cluster* list, uint i) {
    const Columns columns = load_columns((const float*)(list + i));
    vstore8(columns.lox, 0, search->lox + i), vstore8(columns.hix, 0, search->hix + i);
    vstore8(columns.loy, 0, search->loy + i), vstore8(columns.hiy, 0, search->hiy + i);
    vstore8(columns.loz, 0, search->loz + i), vstore8(columns.hiz, 0, search->hiz + i);
}

/// Appends boxes after the last cluster that are so large that their union with any other has an infinite area.
static inline void store_sentinels(Search* search, uint count) {
    const float8 low = (float8)(-1e30f), high = (float8)(1e30f);
    for (uint i = count; i < count + 2 * LANES; i += LANES) {
        vstore8(low, 0, search->lox + i), vstore8(low, 0, search->loy + i), vstore8(low, 0, search->loz + i);
        vstore8(high, 0, search->hix + i), vstore8(high, 0, search->hiy + i), vstore8(high, 0, search->hiz + i);
    }
}

static inline float8 lesser8(float8 a, float8 b) { return select(b, a, a < b); }
static inline float8 greater8(float8 a, float8 b) { return select(b, a, a > b); }

/// Keys of clusters i .. i + 7 and each of the next SEARCH_RADIUS.
static inline void measure_pairs(Search* search, uint i) {
    const float8 lox = vload8(0, search->lox + i), loy = vload8(0, search->loy + i), loz = vload8(0, search->loz + i);
    const float8 hix = vload8(0, search->hix + i), hiy = vload8(0, search->hiy + i), hiz = vload8(0, search->hiz + i);
    const uint8 own = (uint8)(0, 1, 2, 3, 4, 5, 6, 7) + i;
    for (uint step = 1; step <= SEARCH_RADIUS; ++step) {
        const uint j = i + step;
        const float8 x = greater8(hix, vload8(0, search->hix + j)) - lesser8(lox, vload8(0, search->lox + j));
        const float8 y = greater8(hiy, vload8(0, search->hiy + j)) - lesser8(loy, vload8(0, search->loy + j));
        const float8 z = greater8(hiz, vload8(0, search->hiz + j)) - lesser8(loz, vload8(0, search->loz + j));
        vstore8(PAIR_KEY(as_uint8, x, y, z, own ^ (own + step)), 0, search->key[step - 1] + SEARCH_RADIUS + i);
    }
}

/// The minimum keys of clusters i .. i + 7.
static inline void choose_nearest(Search* search, uint i) {
    uint8 least = (uint8)(NO_PAIR);
    for (uint step = 1; step <= SEARCH_RADIUS; ++step) {
        const uint* keys = search->key[step - 1] + SEARCH_RADIUS + i;
        least = min(least, min(vload8(0, keys), vload8(0, keys - step)));
    }
    vstore8(least, 0, search->least + i);
}

/// Bit i: cluster i and its nearest cluster are mutual nearest neighbours.
static inline uint find_mutual(Search* search, const Cluster* list, uint count) {
    for (uint i = 0; i < count; i += LANES) load_clusters(search, list, i);
    store_sentinels(search, count);
    for (uint i = 0; i < count; i += LANES) measure_pairs(search, i);
    for (uint i = 0; i < count; i += LANES) choose_nearest(search, i);
    uint mutual = 0;
    for (uint i = 0; i < count; ++i) {
        const uint key = search->least[i];
        mutual |= (uint)(search->least[i ^ (key & PAIR_INDEX)] == key) << i;
    }
    return mutual;
}

/// Merges mutual nearest neighbours from `begin` to the end of the list until at most `limit` clusters are left.
static inline void merge_down(global BvhNode* nodes, Stack* stack, Search* search, uint begin, uint limit) {
    Cluster* list = stack->list + begin;
    uint count = stack->length - begin;
    while (count > limit) {
        const uint mutual = find_mutual(search, list, count);
        uint left = 0;
        for (uint i = 0; i < count; ++i) {
            const uint other = i ^ (search->least[i] & PAIR_INDEX);
            if ((mutual >> i & 1) == 0) list[left++] = list[i];
            else if (i < other) list[left++] = merge_clusters(nodes, stack, list[i], list[other]);
        }
        count = left;
    }
    stack->length = begin + count;
}

/// Joins the subtree at the end of the list, `added`, with its left neighbours as far as possible. It ends with leaf `last`, whose
/// right border has level `right`.
static inline void add_subtree(global BvhNode* nodes, Stack* stack, Search* search, Waiting added, uint last, uint right,
                               uint valid) {
    while (added.left <= right && stack->depth > stack->outward) {
        added = stack->waiting[--stack->depth];
        const uint size = last - added.first + 1;
        if (size > MAX_CLUSTERS || size == valid)
            merge_down(nodes, stack, search, added.begin, size == valid ? 1 : MAX_CLUSTERS);
    }
    stack->waiting[stack->depth++] = added;
    if (added.left <= right) stack->outward = stack->depth;
}

static inline void begin_stack(Stack* stack, Search* search, uint node, uint node_end) {
    stack->depth = stack->outward = stack->length = stack->range = 0;
    stack->node = node, stack->node_end = node_end;
    for (uint row = 0; row < SEARCH_RADIUS; ++row) vstore8((uint8)(NO_PAIR), 0, search->key[row]);
}

/// One item per range. `pieces` receives the remaining subtrees as (clusters, last leaf), MAX_WAITING per range; `clusters`
/// receives the clusters of each from its first leaf on; `piece_counts` receives (pieces, nodes created).
kernel void build_hploc_ranges(global const float* positions, global const uint* indices,
                               global const uint* geometries, global const uint* masks, global const Code* codes,
                               global const uint* order, global BvhNode* nodes, global LeafTriangle* leaves,
                               global uint* clusters, global const BvhHeader* header, uint ranges,
                               global uint2* pieces, global uint2* piece_counts) {
    const uint range = get_global_id(0), valid = header->valid;
    if (range >= ranges) return;
    const uint begin = range_begin(range, ranges, valid), end = range_begin(range + 1, ranges, valid);
    Stack stack;
    Search search;
    begin_stack(&stack, &search, begin, CLARAY_NO_CHILD);
    uint left = border(codes, begin - 1, valid);
    for (uint leaf = begin; leaf < end; ++leaf) {
        prefetch_leaf(positions, indices, geometries, order, leaf, valid);
        const uint primitive = order[leaf];
        const Triangle triangle = load_triangle(positions, indices, primitive);
        const float4 v0 = (float4)(triangle.v0, 0.0f), v1 = (float4)(triangle.v1, 0.0f),
                     v2 = (float4)(triangle.v2, 0.0f);
        stream_leaf(&leaves[leaf], v0, v1, v2, primitive, geometries, masks);
        Cluster cluster = {lesser(lesser(v0, v1), v2), greater(greater(v0, v1), v2)};
        cluster.lo.w = as_float(CLARAY_LEAF | leaf), cluster.hi.w = as_float(1u);
        const Waiting added = {leaf, left, stack.length};
        stack.list[stack.length++] = cluster;
        left = border(codes, leaf, valid);
        add_subtree(nodes, &stack, &search, added, leaf, left, valid);
    }
    for (uint i = 0; i < stack.depth; ++i) {
        const bool top = i + 1 == stack.depth;
        const Waiting piece = stack.waiting[i];
        const uint count = (top ? stack.length : stack.waiting[i + 1].begin) - piece.begin;
        for (uint k = 0; k < count; ++k) clusters[piece.first + k] = as_uint(stack.list[piece.begin + k].lo.w);
        pieces[range * MAX_WAITING + i] = (uint2)(count, top ? end - 1 : stack.waiting[i + 1].first - 1);
    }
    for (uint node = stack.node; node < end; ++node) store_free_node(&nodes[node]);  // until they are joined
    finish_streaming();
    piece_counts[range] = (uint2)(stack.depth, stack.node - begin);
}

static inline Cluster load_cluster(global const BvhNode* nodes, global const LeafTriangle* leaves, uint child) {
    const Box box = box_of_child(nodes, leaves, child);
    const uint height_count = is_leaf(child) ? CLARAY_LEAF_COUNT(child) : nodes[child].height_count;
    const Cluster cluster = {(float4)(box.lo, as_float(child)), (float4)(box.hi, as_float(height_count))};
    return cluster;
}

/// One item joins the remaining subtrees of all ranges. Nodes get numbers that the ranges did not use.
kernel void join_hploc_ranges(global const Code* codes, global BvhNode* nodes, global const LeafTriangle* leaves,
                              global const uint* clusters, global BvhHeader* header, uint ranges,
                              global const uint2* pieces, global const uint2* piece_counts) {
    const uint valid = header->valid;
    if (get_global_id(0) != 0 || valid == 0) return;
    Stack stack;
    Search search;
    begin_stack(&stack, &search, 0, 0);
    stack.ranges = ranges, stack.valid = valid, stack.piece_counts = piece_counts;
    uint left = NO_BORDER, first = 0;
    for (uint range = 0; range < ranges; ++range) {
        for (uint i = 0; i < piece_counts[range].x; ++i) {
            const uint2 piece = pieces[range * MAX_WAITING + i];
            const Waiting added = {first, left, stack.length};
            for (uint k = 0; k < piece.x; ++k)
                stack.list[stack.length++] = load_cluster(nodes, leaves, clusters[first + k]);
            left = border(codes, piece.y, valid);
            add_subtree(nodes, &stack, &search, added, piece.y, left, valid);
            first = piece.y + 1;
        }
    }
    const Cluster root = stack.list[0];
    const uint child = as_uint(root.lo.w);
    if (!is_leaf(child)) nodes[child].parent = CLARAY_NO_CHILD;
    const Box box = {root.lo.xyz, root.hi.xyz};
    finish_tree(header, child, box, is_leaf(child) ? 0 : as_uint(root.hi.w) >> 24);
}
