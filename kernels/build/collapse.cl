// The wide tree from the binary one, level by level from the root: a wide node starts from a binary node's children and
// opens the one with the largest area until it is full (Wald et al. 2008, "Getting Rid of Packets").
#include "build/triangles.clh"

/// A subtree of so few leaves becomes one block of triangles.
static inline bool fits_block(global const BvhNode* nodes, uint child) {
    return is_leaf(child) || (nodes[child].height_count & CLARAY_COUNT_LIMIT) <= CLARAY_BLOCK;
}

/// Stores row i of four leaves, 3 coordinates and a word each, as four rows of a block.
#define STORE_ROWS(row, to_x, to_y, to_z, to_w)                                                              \
    vstore4((float4)(a[row].x, b[row].x, c[row].x, d[row].x), 0, to_x);                                      \
    vstore4((float4)(a[row].y, b[row].y, c[row].y, d[row].y), 0, to_y);                                      \
    vstore4((float4)(a[row].z, b[row].z, c[row].z, d[row].z), 0, to_z);                                      \
    vstore4(as_uint4((float4)(a[row].w, b[row].w, c[row].w, d[row].w)), 0, to_w)

/// The leaves below `child`, at most CLARAY_BLOCK, from left to right; returns how many. Lanes that are left over repeat
/// the last leaf and are not looked at.
static inline uint fill_block(global const BvhNode* nodes, global const LeafTriangle* leaves, uint child,
                              global TriangleBlock* block) {
    uint stack[CLARAY_BLOCK], slots[CLARAY_BLOCK], depth = 0, count = 0;
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
    for (uint lane = count; lane < CLARAY_BLOCK; ++lane) slots[lane] = slots[count - 1];
    global const float4* a = (global const float4*)&leaves[slots[0]];
    global const float4* b = (global const float4*)&leaves[slots[1]];
    global const float4* c = (global const float4*)&leaves[slots[2]];
    global const float4* d = (global const float4*)&leaves[slots[3]];
    STORE_ROWS(0, block->v0x, block->v0y, block->v0z, block->primitive);
    STORE_ROWS(1, block->v1x, block->v1y, block->v1z, block->geometry);
    STORE_ROWS(2, block->v2x, block->v2y, block->v2z, block->mask);
    return count;
}

typedef struct Slots {
    uint child[CLARAY_WIDTH];
    Box box[CLARAY_WIDTH];
    float area[CLARAY_WIDTH];  // negative for what becomes a block
    uint count;
} Slots;

static inline void set_slot(global const BvhNode* nodes, Slots* slots, uint at, uint child, Box box) {
    slots->child[at] = child;
    slots->box[at] = box;
    slots->area[at] = fits_block(nodes, child) ? -1.0f : half_area(box);
}

/// Replaces slot `at` by the two children of its node.
static inline void open_slot(global const BvhNode* nodes, Slots* slots, uint at) {
    global const BvhNode* node = &nodes[slots->child[at]];
    set_slot(nodes, slots, at, node->child0, child_box(node, 0));
    set_slot(nodes, slots, slots->count++, node->child1, child_box(node, 1));
}

static inline Slots open_children(global const BvhNode* nodes, global const LeafTriangle* leaves, uint root) {
    Slots slots;
    slots.count = 1;
    set_slot(nodes, &slots, 0, root, box_of_child(nodes, leaves, root));
    if (!is_leaf(root)) open_slot(nodes, &slots, 0);  // even where all would fit one block
    while (slots.count < CLARAY_WIDTH) {
        uint best = 0;
        for (uint i = 1; i < slots.count; ++i)
            if (slots.area[i] > slots.area[best]) best = i;
        if (slots.area[best] < 0.0f) break;
        open_slot(nodes, &slots, best);
    }
    return slots;
}

static inline void store_slot(global WideNode* wide, uint i, Box box) {
    wide->lox[i] = box.lo.x, wide->loy[i] = box.lo.y, wide->loz[i] = box.lo.z;
    wide->hix[i] = box.hi.x, wide->hiy[i] = box.hi.y, wide->hiz[i] = box.hi.z;
}

/// The first wide node stands for the binary root.
kernel void begin_collapse(global BvhHeader* header, global WideNode* wide) {
    if (get_global_id(0) != 0) return;
    header->wide_nodes = header->valid != 0;
    header->wide_blocks = 0;
    wide[0].source[0] = header->root;
}

/// Fills a wide node, whose `source[0]` names the binary node, and appends the nodes below it: returns the first, their
/// number in `below_count`.
static inline uint collapse_node(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                                 global TriangleBlock* blocks, volatile global BvhHeader* header, uint index,
                                 uint* below_count) {
    const Slots slots = open_children(nodes, leaves, wide[index].source[0]);
    const Box none = {(float3)(INFINITY), (float3)(-INFINITY)};
    uint blocks_here = 0;
    for (uint i = 0; i < slots.count; ++i) blocks_here += slots.area[i] < 0.0f;
    *below_count = slots.count - blocks_here;
    uint block = atomic_add(&header->wide_blocks, blocks_here);
    const uint first_below = *below_count != 0 ? atomic_add(&header->wide_nodes, *below_count) : 0;
    uint below = first_below;
    for (uint i = 0; i < CLARAY_WIDTH; ++i) {
        const bool used = i < slots.count;
        const uint source = used ? slots.child[i] : CLARAY_NO_CHILD;
        store_slot(&wide[index], i, used ? slots.box[i] : none);
        wide[index].source[i] = source;
        if (!used) {
            wide[index].child[i] = CLARAY_NO_CHILD;
        } else if (slots.area[i] < 0.0f) {
            const uint triangles = fill_block(nodes, leaves, source, &blocks[block]);
            wide[index].child[i] = CLARAY_LEAF | ((triangles - 1) << CLARAY_LEAF_COUNT_SHIFT) | block++;
        } else {
            wide[below].source[0] = source;
            wide[index].child[i] = below++;
        }
    }
    return first_below;
}

/// One level: wide nodes begin .. end - 1, one item each.
kernel void collapse_level(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                           global TriangleBlock* blocks, volatile global BvhHeader* header, uint begin, uint end) {
    const uint index = begin + get_global_id(0);
    if (index >= end) return;
    uint below_count;
    collapse_node(nodes, leaves, wide, blocks, header, index, &below_count);
}

/// All that is below wide nodes begin .. end - 1, one item a subtree, depth first: a small subtree's nodes lie close
/// together and stay in the cache, and so will the wide nodes when they are traversed.
kernel void collapse_subtrees(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                              global TriangleBlock* blocks, volatile global BvhHeader* header, uint begin, uint end) {
    if (begin + get_global_id(0) >= end) return;
    uint stack[CLARAY_MAX_HEIGHT * (CLARAY_WIDTH - 1) + 1], depth = 0;
    stack[depth++] = begin + get_global_id(0);
    while (depth != 0) {
        uint below_count;
        const uint first = collapse_node(nodes, leaves, wide, blocks, header, stack[--depth], &below_count);
        for (uint i = below_count; i-- > 0;) stack[depth++] = first + i;
    }
}

/// Copies boxes and triangles of a refitted binary tree into the wide tree; one item a wide node.
kernel void refit_wide(global const BvhNode* nodes, global const LeafTriangle* leaves, global WideNode* wide,
                       global TriangleBlock* blocks, global const BvhHeader* header) {
    const uint index = get_global_id(0);
    if (index >= header->wide_nodes) return;
    for (uint i = 0; i < CLARAY_WIDTH; ++i) {
        const uint source = wide[index].source[i], child = wide[index].child[i];
        if (child == CLARAY_NO_CHILD) continue;
        store_slot(&wide[index], i, box_of_child(nodes, leaves, source));
        if (is_leaf(child)) fill_block(nodes, leaves, source, &blocks[child & CLARAY_SLOT]);
    }
}
