// The radix tree from the top down: every inner node finds its own range and its split by binary searches, all at once (Karras
// 2012, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees"); then leaves climb and fit the boxes. For
// comparison with the one pass of bvh/lbvh.cl, which gives the same tree: nodes are numbered by their splits here, too.
#include "bvh/radix_tree.clh"

/// Length of the prefix that the codes of leaves i and j share, continued by their indices where the codes are equal; -1 beyond
/// the first and last leaf.
static inline int shared_prefix(global const Code* codes, int i, int j, int valid) {
    if (j < 0 || j >= valid) return -1;
    const ulong difference = codes[i] ^ codes[j];
    return difference != 0 ? (int)clz(difference) : 64 + (int)clz((uint)i ^ (uint)j);  // mutant: karras-equal-codes
}

/// One item per inner node. The range of Karras' node i begins or ends at leaf i. `splits[i]` is the last leaf of its left child.
/// `parents` holds the parent of inner node i at i, and of leaf i at valid - 1 + i.
kernel void find_splits(global const Code* codes, global const BvhHeader* header, global uint* splits, global uint* parents) {
    const int i = get_global_id(0), valid = header->valid;
    if (i == 0) parents[0] = CLARAY_NO_CHILD;
    if (i >= valid - 1) return;
    const int d = shared_prefix(codes, i, i + 1, valid) > shared_prefix(codes, i, i - 1, valid) ? 1 : -1;
    const int outside = shared_prefix(codes, i, i - d, valid);
    int most = 2, length = 0;
    while (shared_prefix(codes, i, i + most * d, valid) > outside) most *= 2;
    for (int step = most / 2; step > 0; step /= 2)
        if (shared_prefix(codes, i, i + (length + step) * d, valid) > outside) length += step;
    const int j = i + length * d, prefix = shared_prefix(codes, i, j, valid);
    int left = 0, step = length;
    do {
        step = (step + 1) / 2;
        if (shared_prefix(codes, i, i + (left + step) * d, valid) > prefix) left += step;
    } while (step > 1);
    const int split = i + left * d + min(d, 0);
    splits[i] = split;
    parents[min(i, j) == split ? valid - 1 + split : split] = i;
    parents[max(i, j) == split + 1 ? valid - 1 + split + 1 : split + 1] = i;
}

/// One item per leaf; see build_lbvh. `arrivals` holds NO_ARRIVAL for all nodes.
kernel void fit_boxes(global const float* positions, global const uint* indices, global const uint* geometries,
                      global const uint* masks, global const uint* order, global const uint* splits, global const uint* parents,
                      global BvhNode* nodes, global LeafTriangle* leaves, volatile global uint* arrivals, global BvhHeader* header) {
    const uint leaf = get_global_id(0), valid = header->valid;
    if (leaf >= valid) return;
    const uint primitive = order[leaf];
    const Triangle triangle = load_triangle(positions, indices, primitive);
    store_leaf(&leaves[leaf], triangle, primitive, geometries, masks);
    Box box = box_of(triangle);
    uint first = leaf, last = leaf, child = CLARAY_LEAF | leaf, height = 0;
    uint parent = valid > 1 ? parents[valid - 1 + leaf] : CLARAY_NO_CHILD;
    while (parent != CLARAY_NO_CHILD) {
        const uint split = splits[parent], side = last == split ? 0 : 1;
        global BvhNode* node = &nodes[split];
        store_child_box(node, side, box);
        if (side == 0) node->child0 = child;
        else node->child1 = child;
        ((global uchar*)&node->height_count)[side] = (uchar)height;
        device_fence();  // releases the stores to the node ...
        const uint other_end = atomic_xchg(&arrivals[split], side == 0 ? first : last);
        if (other_end == NO_ARRIVAL) return;
        device_fence();  // ... and acquires the sibling's stores
        if (side == 0) last = other_end;
        else first = other_end;
        const Box other = child_box(node, side ^ 1);
        const uint other_child = child_of(node, side ^ 1);
        const uint joined = side == 0 ? joined_leaf(box, child, other, other_child) : joined_leaf(other, other_child, box, child);
        box = box_union(box, other);
        parent = parents[parent];
        if (joined != CLARAY_NO_CHILD) {
            store_free_node(node);
            child = joined;
            continue;
        }
        height = 1 + max(height, (uint)((global const uchar*)&node->height_count)[side ^ 1]);
        child = split;
        node->parent = parent == CLARAY_NO_CHILD ? CLARAY_NO_CHILD : splits[parent];
        node->height_count = (height << 24) | min(last - first + 1, CLARAY_COUNT_LIMIT);
    }
    finish_tree(header, child, box, height);
}
