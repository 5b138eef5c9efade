// Builds the wide tree from the binary tree, level by level from the root. A wide node has the children that cost least
// (cost_subtrees). Where the build must be fast, it begins with a binary node's children and replaces the child of the largest area
// by its children until the node is full (Wald et al. 2008, "Getting Rid of Packets").
#include "bvh/columns.clh"
#include "bvh/triangles.clh"

#ifndef LEAF_SHAPE
#define LEAF_SHAPE 0  // 0: triangles; 1: boxes of primitives; 2: their capsules
#endif
#if LEAF_SHAPE == 0
#define LEAF_BLOCK CLARAY_BLOCK  // most leaves in a block
#define BLOCKS TriangleBlock
#else
#define LEAF_BLOCK CLARAY_WIDTH
#define BLOCKS PrimitiveBlock
#include "bvh/capsules.clh"
#endif

/// Number of leaves below a child; a subtree of at most LEAF_BLOCK leaves becomes one block.
static inline uint leaves_below(global const BvhNode* nodes, uint child) {
    return is_leaf(child) ? 1 : nodes[child].height_count & CLARAY_COUNT_LIMIT;
}

/// Subtrees of at most this many leaves are prefetched as a whole.
#define FETCHED_LEAVES 64u

static inline uint end_leaf(global const BvhNode* nodes, uint child, uint side) {
    while (!is_leaf(child)) child = child_of(&nodes[child], side);
    return child & CLARAY_SLOT;
}

#if LEAF_SHAPE == 0
/// Transposes vertex number `row` of four leaves (3 coordinates and a word each) into four rows of a block.
#define STORE_ROWS(row, to_x, to_y, to_z, to_w)                                                              \
    store_streaming4((float4)(a[row].x, b[row].x, c[row].x, d[row].x), (global float4*)(to_x));              \
    store_streaming4((float4)(a[row].y, b[row].y, c[row].y, d[row].y), (global float4*)(to_y));              \
    store_streaming4((float4)(a[row].z, b[row].z, c[row].z, d[row].z), (global float4*)(to_z));              \
    store_streaming4((float4)(a[row].w, b[row].w, c[row].w, d[row].w), (global float4*)(to_w))

static inline void fill_block(global const LeafTriangle* leaves, const uint* slots, global TriangleBlock* block) {
    global const float4* a = (global const float4*)&leaves[slots[0]];
    global const float4* b = (global const float4*)&leaves[slots[1]];
    global const float4* c = (global const float4*)&leaves[slots[2]];
    global const float4* d = (global const float4*)&leaves[slots[3]];
    STORE_ROWS(0, block->v0x, block->v0y, block->v0z, block->primitive);
    STORE_ROWS(1, block->v1x, block->v1y, block->v1z, block->geometry);
    STORE_ROWS(2, block->v2x, block->v2y, block->v2z, block->mask);
}
#else
/// The builder's triangle of a primitive has the corners lo, hi and, of a capsule, the start of the axis.
static inline void fill_lane(global const LeafTriangle* leaf, bool used, uint lane, global PrimitiveBlock* block) {
    const float3 lo = (float3)(leaf->v0x, leaf->v0y, leaf->v0z), hi = (float3)(leaf->v1x, leaf->v1y, leaf->v1z);
    const float3 start = (float3)(leaf->v2x, leaf->v2y, leaf->v2z), axis = capsule_axis(lo, hi, start);
#if LEAF_SHAPE == 1
    const float rows[7] = {lo.x, used ? hi.x : -INFINITY, lo.y, hi.y, lo.z, hi.z, 0.0f};
#else
    const float rows[7] = {start.x, start.y, start.z, axis.x, axis.y, axis.z, used ? capsule_radius(lo, hi, start) : -INFINITY};
#endif
    for (uint row = 0; row < 7; ++row) block->shape[row][lane] = rows[row];
    block->primitive[lane] = leaf->primitive;
}

static inline void fill_block(global const LeafTriangle* leaves, const uint* slots, global PrimitiveBlock* block) {
    for (uint lane = 0; lane < LEAF_BLOCK; ++lane)
        fill_lane(&leaves[slots[lane]], lane == 0 || slots[lane] != slots[lane - 1], lane, block);
}
#endif

/// The cost of a child as at most `slots` children of a wide node, from the table of cost_subtrees.
static inline float cost_of_child(global const float* costs, global const BvhNode* nodes, uint index, uint side, uint slots) {
    const uint child = child_of(&nodes[index], side);
    if (leaves_below(nodes, child) <= LEAF_BLOCK) return half_area(child_box(&nodes[index], side));
    return costs[CLARAY_WIDTH * (size_t)child + slots - 1];
}

typedef struct Share {
    float cost;
    uint left;
} Share;

/// The best way to share slots of a wide node between the two children of a binary node.
static inline Share best_share(global const float* costs, global const BvhNode* nodes, uint index, uint slots) {
    Share best = {INFINITY, 1};
    for (uint left = 1; left < slots; ++left) {
        const float cost = cost_of_child(costs, nodes, index, 0, left) + cost_of_child(costs, nodes, index, 1, slots - left);
        if (cost < best.cost) best.cost = cost, best.left = left;
    }
    return best;
}

static inline void cost_subtree(global const BvhNode* nodes, uint index, global float* costs) {
    if (leaves_below(nodes, index) <= LEAF_BLOCK) return;
    const Box box = box_union(child_box(&nodes[index], 0), child_box(&nodes[index], 1));
    float cost = half_area(box) + best_share(costs, nodes, index, CLARAY_WIDTH).cost;
    for (uint slots = 1; slots < CLARAY_WIDTH; ++slots) {
        if (slots > 1) cost = fmin(cost, best_share(costs, nodes, index, slots).cost);
        costs[CLARAY_WIDTH * (size_t)index + slots - 1] = cost;
    }
}

/// The least cost of each binary node as at most 1 .. 7 children of a wide node, where every wide node and every block costs its area
/// (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3). Climbs as refit.cl
/// does. `arrivals` is zero before.
kernel void cost_subtrees(global const BvhNode* nodes, global const BvhHeader* header, volatile global uint* arrivals,
                          global float* costs) {
    uint index = get_global_id(0);
    if (index >= header->inner_nodes || is_free_node(&nodes[index])) return;
    uint ready = (is_leaf(nodes[index].child0) ? 1 : 0) + (is_leaf(nodes[index].child1) ? 1 : 0);
    while (ready != 0 && index != CLARAY_NO_CHILD && both_children_ready(arrivals, index, ready)) {
        cost_subtree(nodes, index, costs);
        index = nodes[index].parent, ready = 1;
    }
}

/// The leaves below `child` (at most LEAF_BLOCK) from left to right. Unused lanes repeat the last leaf and are ignored.
static inline void list_leaves(global const BvhNode* nodes, uint child, uint* slots) {
    uint stack[LEAF_BLOCK], depth = 0, count = 0;
    stack[depth++] = child;
    while (depth != 0) {
        const uint top = stack[--depth];
        if (is_leaf(top)) {
            slots[count++] = top & CLARAY_SLOT;
        } else {
            stack[depth++] = nodes[top].child1;
            stack[depth++] = nodes[top].child0;
        }
    }
    for (uint lane = count; lane < LEAF_BLOCK; ++lane) slots[lane] = slots[count - 1];
}

/// `first`, the first leaf, is only known if nodes are numbered by their splits.
typedef struct Subtree {
    uint child, first, count;
} Subtree;

static inline void prefetch_children(global const BvhNode* nodes, uint index) {
    prefetch_line(&nodes[nodes[index].child0 & CLARAY_SLOT]);
    prefetch_line(&nodes[nodes[index].child1 & CLARAY_SLOT]);
}

// ---- output of an item ---------------------------------------------------------------------------------------------

/// Blocks are filled with a delay, after their data was prefetched: this many blocks later their leaves are listed, and after as
/// many again they are filled.
#define DELAY 16u

typedef struct Output {
    global const BvhNode* nodes;
    global const LeafTriangle* leaves;
    global WideNode* wide;
    global BLOCKS* blocks;
    volatile global BvhHeader* header;
    global const float* costs;  // of cost_subtrees, or none
    uint node, node_end, block, block_end;  // reserved numbers; many at once, so that items rarely contend for the counters
    uint nodes_at_once, blocks_at_once;
    bool by_split;
    uint fills;                                 // number of fills requested so far
    uint fill_slots[2 * DELAY][LEAF_BLOCK];  // at first only the child
    uint fill_block[2 * DELAY];
} Output;

static inline Output begin_output(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                                  global BLOCKS* blocks, volatile global BvhHeader* header, global const float* costs,
                                  uint at_once, bool by_split) {
    Output out;
    out.nodes = nodes, out.leaves = leaves, out.wide = wide, out.blocks = blocks, out.header = header, out.costs = costs;
    out.node = out.node_end = out.block = out.block_end = out.fills = 0;
    out.by_split = by_split;
    out.nodes_at_once = at_once, out.blocks_at_once = 2 * at_once - 1;
    return out;
}

static inline uint take_node(Output* out) {
    if (out->node == out->node_end) {
        out->node = atomic_add(&out->header->wide_nodes, out->nodes_at_once);
        out->node_end = out->node + out->nodes_at_once;
    }
    return out->node++;
}

static inline uint take_block(Output* out) {
    if (out->block == out->block_end) {
        out->block = atomic_add(&out->header->wide_blocks, out->blocks_at_once);
        out->block_end = out->block + out->blocks_at_once;
    }
    return out->block++;
}

static inline void fetch_leaves(const Output* out, const uint* slots) {
    for (uint lane = 0; lane < LEAF_BLOCK; ++lane) prefetch_line(&out->leaves[slots[lane]]);
    prefetch_line(&out->leaves[slots[LEAF_BLOCK - 1]].mask);
}

static inline void list_fill(Output* out, uint fill) {
    if (out->by_split) return;
    uint* slots = out->fill_slots[fill % (2 * DELAY)];
    list_leaves(out->nodes, slots[0], slots);
    fetch_leaves(out, slots);
}

static inline void finish_fill(Output* out, uint fill) {
    const uint at = fill % (2 * DELAY);
    fill_block(out->leaves, out->fill_slots[at], &out->blocks[out->fill_block[at]]);
}

/// Allocates a block for the leaves below a subtree; returns a reference to it.
static inline uint add_block(Output* out, Subtree subtree) {
    const uint fill = out->fills++, at = fill % (2 * DELAY), block = take_block(out);
    if (fill >= DELAY) list_fill(out, fill - DELAY);
    if (fill >= 2 * DELAY) finish_fill(out, fill - 2 * DELAY);
    uint* slots = out->fill_slots[at];
    out->fill_block[at] = block;
    slots[0] = subtree.child;
    if (out->by_split) {
        for (uint lane = 0; lane < LEAF_BLOCK; ++lane) slots[lane] = subtree.first + min(lane, subtree.count - 1);
        fetch_leaves(out, slots);
    } else if (subtree.count > 2) {
        prefetch_children(out->nodes, subtree.child);
    }
    const uint count = LEAF_SHAPE == 0 ? subtree.count - 1 : 0;  // blocks of primitives need none
    return CLARAY_LEAF | count << CLARAY_LEAF_COUNT_SHIFT | block;
}

/// Fills the remaining blocks, and makes unused numbers nodes without children.
static inline void finish_output(Output* out) {
    const uint fills = out->fills;
    for (uint fill = fills > DELAY ? fills - DELAY : 0; fill < fills; ++fill) list_fill(out, fill);
    for (uint fill = fills > 2 * DELAY ? fills - 2 * DELAY : 0; fill < fills; ++fill) finish_fill(out, fill);
    for (; out->node < out->node_end; ++out->node)
        for (uint i = 0; i < CLARAY_WIDTH; ++i) out->wide[out->node].child[i] = CLARAY_NO_CHILD;
    finish_streaming();
}

// ---- one wide node -------------------------------------------------------------------------------------------------

typedef struct Slots {
    float boxes[CLARAY_WIDTH][8];  // lo and the child's bits, hi
    ulong rank[CLARAY_WIDTH];      // by largest area, then by lowest slot; 0: not to be opened
    Subtree subtrees[CLARAY_WIDTH];
    uint count;
} Slots;

/// Prefetches the nodes of a small subtree, or the first nodes of a larger one. Node i of the linear tree splits after leaf i, so
/// that nodes have the numbers of leaves. Clustering on CPUs numbers nodes in the order of creation, the root last.
static inline void fetch_subtree(const Output* out, Subtree subtree) {
    if (subtree.count < 2) return;
    const uint wanted = subtree.count <= FETCHED_LEAVES ? subtree.count - 1 : 1;
    const uint first = out->by_split && wanted > 1 ? subtree.first : subtree.child + 1 - min(subtree.child + 1, wanted);
    for (uint i = first; i < first + wanted; ++i) prefetch_line(&out->nodes[i]);
}

static inline void set_slot(Slots* slots, uint at, Subtree subtree, float4 lo, float4 hi) {
    const float4 extent = hi - lo;
    const float4 sides = extent * extent.yzxw;
    const float area = sides.x + sides.y + sides.z;  // half_area
    lo.w = as_float(subtree.child);
    vstore4(lo, 0, slots->boxes[at]);
    vstore4(hi, 1, slots->boxes[at]);
    slots->subtrees[at] = subtree;
    slots->rank[at] = subtree.count <= LEAF_BLOCK ? 0 : (ulong)as_uint(area) << 32 | (CLARAY_WIDTH - at);
}

/// Replaces slot `at` by the two children of `subtree`, a node.
static inline void open_slot(const Output* out, Slots* slots, uint at, Subtree subtree) {
    global const BvhNode* node = &out->nodes[subtree.child];
    global const float4* rows = (global const float4*)node;
    Subtree a = {node->child0, subtree.first, 0}, b = {node->child1, subtree.child + 1, 0};
    if (out->by_split) {
        a.count = subtree.child + 1 - subtree.first;
        b.count = subtree.count - a.count;
    } else {
        a.count = leaves_below(out->nodes, a.child);
        b.count = leaves_below(out->nodes, b.child);
    }
    if (subtree.count > FETCHED_LEAVES) {
        fetch_subtree(out, a);
        fetch_subtree(out, b);
    }
    const float4 xy0 = rows[0], xy1 = rows[1], z = rows[2];
    set_slot(slots, at, a, (float4)(xy0.xz, z.x, 0.0f), (float4)(xy0.yw, z.y, 0.0f));
    set_slot(slots, slots->count++, b, (float4)(xy1.xz, z.z, 0.0f), (float4)(xy1.yw, z.w, 0.0f));
}

/// Opens the root, and slots until all children are those that cost least.
static inline void open_best(const Output* out, Subtree root, Slots* slots) {
    uint most[CLARAY_WIDTH];  // children in place of a slot
    most[0] = CLARAY_WIDTH, slots->subtrees[0] = root, slots->rank[0] = 1;
    for (uint at = 0; at < slots->count;) {
        const Subtree subtree = slots->subtrees[at];
        const bool is_root = slots->count == 1;
        if (slots->rank[at] == 0) most[at] = 1;  // a block
        Share share = {INFINITY, 0};
        for (; most[at] > 1; --most[at]) {
            share = best_share(out->costs, out->nodes, subtree.child, most[at]);
            if (is_root || share.cost <= out->costs[CLARAY_WIDTH * (size_t)subtree.child + most[at] - 1]) break;
        }
        if (most[at] == 1) {
            ++at;
            continue;
        }
        most[slots->count] = most[at] - share.left, most[at] = share.left;
        open_slot(out, slots, at, subtree);
    }
}

/// The slots of the wide node for `root`; unused slots hold a box that no ray hits.
static inline void open_children(const Output* out, Subtree root, Slots* slots) {
    for (uint i = 0; i < CLARAY_WIDTH; ++i) {
        vstore4((float4)((float3)(INFINITY), as_float(CLARAY_NO_CHILD)), 0, slots->boxes[i]);
        vstore4((float4)(-INFINITY), 1, slots->boxes[i]);
        slots->rank[i] = 0;
    }
    slots->count = 1;
    if (is_leaf(root.child)) {
        const Box box = box_of_child(out->nodes, out->leaves, root.child);
        set_slot(slots, 0, root, (float4)(box.lo, 0.0f), (float4)(box.hi, 0.0f));
        return;
    }
    if (out->costs) open_best(out, root, slots);
    else open_slot(out, slots, 0, root);  // even if all leaves fit in one block
    while (slots->count < CLARAY_WIDTH) {
        ulong best = 0;
        for (uint i = 0; i < CLARAY_WIDTH; ++i) best = max(best, slots->rank[i]);
        if (best == 0) break;
        const uint at = CLARAY_WIDTH - (uint)best;
        open_slot(out, slots, at, slots->subtrees[at]);
    }
}

typedef struct Wide {
    uint index;
    Subtree root;
} Wide;

/// Fills a wide node. Lists the wide nodes below it and returns their number.
static inline uint collapse_node(Output* out, Wide wide, Wide* below) {
    Slots slots;
    open_children(out, wide.root, &slots);
    uint child[CLARAY_WIDTH], count = 0;
    for (uint i = 0; i < CLARAY_WIDTH; ++i) {
        const Subtree subtree = slots.subtrees[i];
        if (i >= slots.count) {
            child[i] = CLARAY_NO_CHILD;
        } else if (slots.rank[i] == 0) {
            child[i] = add_block(out, subtree);
        } else {
            child[i] = take_node(out);
            if (!out->by_split) prefetch_children(out->nodes, subtree.child);
            const Wide next = {child[i], subtree};
            below[count++] = next;
        }
    }
    const Columns boxes = load_columns(slots.boxes[0]);
    global float8* rows = (global float8*)&out->wide[wide.index];
    store_streaming8(boxes.lox, &rows[0]), store_streaming8(boxes.hix, &rows[1]);
    store_streaming8(boxes.loy, &rows[2]), store_streaming8(boxes.hiy, &rows[3]);
    store_streaming8(boxes.loz, &rows[4]), store_streaming8(boxes.hiz, &rows[5]);
    store_streaming8(as_float8(vload8(0, child)), &rows[6]), store_streaming8(boxes.low, &rows[7]);
    return count;
}

// ---- kernels -------------------------------------------------------------------------------------------------------

/// Builds the wide node whose binary node is in `source[0]`.
static inline Wide prepared_node(const Output* out, uint index) {
    const uint child = out->wide[index].source[0];
    const uint first = end_leaf(out->nodes, child, 0), count = end_leaf(out->nodes, child, 1) - first + 1;
    const Wide wide = {index, {child, first, out->by_split ? count : leaves_below(out->nodes, child)}};
    return wide;
}

/// Starts the wide tree: its first node stands for the binary root.
kernel void begin_collapse(global BvhHeader* header, global WideNode* wide) {
    if (get_global_id(0) != 0) return;
    header->wide_nodes = header->valid != 0;
    header->wide_blocks = 0;
    wide[0].source[0] = header->root;
}

/// One level: wide nodes begin .. end - 1, one item each. `source[0]` is the binary node of a wide node.
kernel void collapse_level(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                           global BLOCKS* blocks, volatile global BvhHeader* header, global const float* costs, uint begin,
                           uint end) {
    const uint index = begin + get_global_id(0);
    if (index >= end) return;
    Output out = begin_output(nodes, leaves, wide, blocks, header, costs, 1, false);
    Wide below[CLARAY_WIDTH];
    const uint count = collapse_node(&out, prepared_node(&out, index), below);
    for (uint i = 0; i < count; ++i) wide[below[i].index].source[0] = below[i].root.child;
    finish_output(&out);
}

/// Everything below wide nodes begin .. end - 1, one item per subtree, depth first: the nodes of a small subtree are close
/// together and stay in the cache, now and when the wide nodes are traversed. The last subtrees come first, because they may
/// still be in the cache. `at_once`: number of wide nodes reserved at once; `by_split`: see fetch_subtree.
kernel void collapse_subtrees(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                              global BLOCKS* blocks, volatile global BvhHeader* header, global const float* costs, uint begin,
                              uint end, uint at_once, uint by_split) {
    if (begin + get_global_id(0) >= end) return;
    const uint index = end - 1 - get_global_id(0);
    Output out = begin_output(nodes, leaves, wide, blocks, header, costs, at_once, by_split != 0);
    Wide stack[CLARAY_MAX_HEIGHT * (CLARAY_WIDTH - 1) + CLARAY_WIDTH];
    uint depth = 0;
    stack[depth++] = prepared_node(&out, index);
    while (depth != 0) {
        const Wide top = stack[--depth];
        depth += collapse_node(&out, top, stack + depth);
    }
    finish_output(&out);
}

/// Copies boxes and triangles of a refitted binary tree into the wide tree; one item per wide node.
kernel void refit_wide(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                       global BLOCKS* blocks, global const BvhHeader* header) {
    const uint index = get_global_id(0);
    if (index >= header->wide_nodes) return;
    for (uint i = 0; i < CLARAY_WIDTH; ++i) {
        const uint source = wide[index].source[i], child = wide[index].child[i];
        if (child == CLARAY_NO_CHILD) continue;
        const Box box = box_of_child(nodes, leaves, source);
        wide[index].lox[i] = box.lo.x, wide[index].loy[i] = box.lo.y, wide[index].loz[i] = box.lo.z;
        wide[index].hix[i] = box.hi.x, wide[index].hiy[i] = box.hi.y, wide[index].hiz[i] = box.hi.z;
        if (!is_leaf(child)) continue;
        uint slots[LEAF_BLOCK];
        list_leaves(nodes, source, slots);
        fill_block(leaves, slots, &blocks[child & CLARAY_SLOT]);
    }
    finish_streaming();
}
