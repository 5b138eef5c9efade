// The tree of lbvh.cl by the serial schedule for CPUs.
#include "bvh/serial/serial.clh"

typedef struct Subtree {
    float4 lo, hi;
    uint child, first, height;
    uint left;  // level of the border before its first leaf
} Subtree;

static inline Subtree join(global BvhNode* nodes, Subtree a, Subtree b, uint last) {
    const uint index = b.first - 1;
    global BvhNode* node = &nodes[index];
    const Box box0 = {a.lo.xyz, a.hi.xyz}, box1 = {b.lo.xyz, b.hi.xyz};
    const uint leaf = joined_leaf(box0, a.child, box1, b.child);
    if (leaf != CLARAY_NO_CHILD) {
        store_free_node(node);
        const Subtree joined = {lesser(a.lo, b.lo), greater(a.hi, b.hi), leaf, a.first, 0, a.left};
        return joined;
    }
    store_boxes(node, a.lo, a.hi, b.lo, b.hi);
    const uint height = 1 + max(a.height, b.height);
    node->child0 = a.child, node->child1 = b.child;
    node->height_count = (height << 24) | min(last - a.first + 1, CLARAY_COUNT_LIMIT);
    if (!is_leaf(a.child)) nodes[a.child].parent = index;
    if (!is_leaf(b.child)) nodes[b.child].parent = index;
    const Subtree joined = {lesser(a.lo, b.lo), greater(a.hi, b.hi), index, a.first, height, a.left};
    return joined;
}

typedef struct Stack {
    Subtree waiting[MAX_WAITING];
    uint depth, outward;  // the lowest `outward` entries wait for something left of the range
} Stack;

/// Joins `subtree` with its left neighbours as far as possible. It ends with leaf `last`, whose right border has level `right`.
static inline void add_subtree(global BvhNode* nodes, Stack* stack, Subtree subtree, uint last, uint right) {
    while (subtree.left <= right && stack->depth > stack->outward)
        subtree = join(nodes, stack->waiting[--stack->depth], subtree, last);
    stack->waiting[stack->depth++] = subtree;
    if (subtree.left <= right) stack->outward = stack->depth;
}

/// One item per range. `pieces` receives the subtrees that this range alone cannot join, as (child, last leaf), in MAX_WAITING
/// slots per range; `piece_counts` receives their number.
kernel void build_lbvh_ranges(global const float* positions, global const uint* indices, global const uint* geometries,
                              global const uint* masks, global const Code* codes, global const uint* order,
                              global BvhNode* nodes, global LeafTriangle* leaves, global const BvhHeader* header,
                              uint ranges, global uint2* pieces, global uint* piece_counts) {
    const uint range = get_global_id(0), valid = header->valid;
    if (range >= ranges) return;
    const uint begin = range_begin(range, ranges, valid), end = range_begin(range + 1, ranges, valid);
    Stack stack;
    stack.depth = stack.outward = 0;
    uint left = border(codes, begin - 1, valid);
    for (uint leaf = begin; leaf < end; ++leaf) {
        prefetch_leaf(positions, indices, geometries, order, leaf, valid);
        const uint primitive = order[leaf];
        const Triangle triangle = load_triangle(positions, indices, primitive);
        const float4 v0 = (float4)(triangle.v0, 0.0f), v1 = (float4)(triangle.v1, 0.0f),
                     v2 = (float4)(triangle.v2, 0.0f);
        stream_leaf(&leaves[leaf], v0, v1, v2, primitive, geometries, masks);
        const uint right = border(codes, leaf, valid);
        const Subtree subtree = {
            lesser(lesser(v0, v1), v2), greater(greater(v0, v1), v2), CLARAY_LEAF | leaf, leaf, 0, left};
        add_subtree(nodes, &stack, subtree, leaf, right);
        left = right;
    }
    for (uint i = 0; i < stack.depth; ++i) {
        const uint last = i + 1 < stack.depth ? stack.waiting[i + 1].first - 1 : end - 1;
        pieces[range * MAX_WAITING + i] = (uint2)(stack.waiting[i].child, last);
    }
    finish_streaming();
    piece_counts[range] = stack.depth;
}

/// One item joins the remaining subtrees of all ranges.
kernel void join_lbvh_ranges(global const Code* codes, global BvhNode* nodes, global const LeafTriangle* leaves,
                             global BvhHeader* header, uint ranges, global const uint2* pieces,
                             global const uint* piece_counts) {
    const uint valid = header->valid;
    if (get_global_id(0) != 0 || valid == 0) return;
    Stack stack;
    stack.depth = stack.outward = 0;
    uint left = NO_BORDER, first = 0;
    for (uint range = 0; range < ranges; ++range) {
        for (uint i = 0; i < piece_counts[range]; ++i) {
            const uint2 piece = pieces[range * MAX_WAITING + i];
            const Box box = box_of_child(nodes, leaves, piece.x);
            const uint right = border(codes, piece.y, valid);
            const uint height = is_leaf(piece.x) ? 0 : nodes[piece.x].height_count >> 24;
            const Subtree subtree = {(float4)(box.lo, 0.0f), (float4)(box.hi, 0.0f), piece.x, first, height, left};
            add_subtree(nodes, &stack, subtree, piece.y, right);
            left = right, first = piece.y + 1;
        }
    }
    const Subtree root = stack.waiting[0];
    if (!is_leaf(root.child)) nodes[root.child].parent = CLARAY_NO_CHILD;
    const Box box = {root.lo.xyz, root.hi.xyz};
    finish_tree(header, root.child, box, root.height);
}
