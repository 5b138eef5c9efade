// Agglomerative linear BVH in one bottom-up pass (Apetrei 2014, "Fast and Simple Agglomerative LBVH Construction"):
// every leaf climbs; at a node the first child to arrive stops and the second goes on with the union of both.
// Node i splits the leaves between i and i + 1, so the tree has one numbering, whatever the order of arrival.
#include "build/radix_tree.clh"

/// `codes` sorted, `order[i]` the triangle of leaf i; `arrivals` holds NO_ARRIVAL for every node.
kernel void build_lbvh(global const float* positions, global const uint* indices, global const uint* geometries,
                       global const uint* masks, global const Code* codes, global const uint* order,
                       global BvhNode* nodes, global LeafTriangle* leaves, volatile global uint* arrivals,
                       global BvhHeader* header) {
    const uint leaf = get_global_id(0), valid = header->valid;
    if (leaf >= valid) return;
    const uint primitive = order[leaf];
    const Triangle triangle = load_triangle(positions, indices, primitive);
    store_leaf(&leaves[leaf], triangle, primitive, geometries, masks);

    Box box = box_of(triangle);
    uint first = leaf, last = leaf, child = CLARAY_LEAF | leaf, height = 0;
    while (last - first + 1 < valid) {
        const bool right_neighbour = parent_is_right(codes, first, last, valid);
        const uint parent = right_neighbour ? last : first - 1;
        const uint side = right_neighbour ? 0 : 1;
        global BvhNode* node = &nodes[parent];
        store_child_box(node, side, box);
        if (side == 0) node->child0 = child;
        else node->child1 = child;
        ((global uchar*)&node->height_count)[side] = (uchar)height;  // a byte each, until both are there
        if (!is_leaf(child)) nodes[child].parent = parent;

        device_fence();  // releases what was written to the node ...
        const uint other_end = atomic_xchg(&arrivals[parent], right_neighbour ? first : last);
        if (other_end == NO_ARRIVAL) return;
        device_fence();  // ... and acquires what the sibling wrote

        if (right_neighbour) last = other_end;
        else first = other_end;
        box = box_union(box, child_box(node, side ^ 1));
        height = 1 + max(height, (uint)((global const uchar*)&node->height_count)[side ^ 1]);
        node->height_count = (height << 24) | min(last - first + 1, CLARAY_COUNT_LIMIT);
        child = parent;
    }
    if (!is_leaf(child)) nodes[child].parent = CLARAY_NO_CHILD;
    finish_tree(header, child, box, height);
}
