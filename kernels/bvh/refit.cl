// Recomputes the boxes of a tree by the climb of lbvh.cl along stored parents.
#include "bvh/triangles.clh"

/// The box of a leaf whose triangle is no longer valid: no ray hits it, and it does not change a union.
static inline Box refit_leaf(global const float* positions, global const uint* indices, global LeafTriangle* leaf) {
    const Triangle t = load_triangle(positions, indices, leaf->primitive);
    leaf->v0x = t.v0.x, leaf->v0y = t.v0.y, leaf->v0z = t.v0.z;
    leaf->v1x = t.v1.x, leaf->v1y = t.v1.y, leaf->v1z = t.v1.z;
    leaf->v2x = t.v2.x, leaf->v2y = t.v2.y, leaf->v2z = t.v2.z;
    const Box none = {(float3)(INFINITY), (float3)(-INFINITY)};
    return triangle_valid(t) ? box_of(t) : none;
}

static inline Box refit_leaves(global const float* positions, global const uint* indices, global LeafTriangle* leaves,
                               uint child) {
    const uint first = child & CLARAY_SLOT, end = first + CLARAY_LEAF_COUNT(child);
    Box box = refit_leaf(positions, indices, &leaves[first]);
    for (uint slot = first + 1; slot < end; ++slot) box = box_union(box, refit_leaf(positions, indices, &leaves[slot]));
    return box;
}

/// One item per node. It computes the boxes of the node's leaves. A node with a leaf continues upwards, or waits for its other
/// child, as in lbvh.cl. `arrivals` is zero before.
kernel void refit_nodes(global const float* positions, global const uint* indices, global BvhNode* nodes,
                        global LeafTriangle* leaves, volatile global uint* arrivals, global BvhHeader* header) {
    const uint start = get_global_id(0);
    if (header->inner_nodes == 0 && start == 0 && header->valid != 0)
        store_header_box(header, refit_leaves(positions, indices, leaves, header->root));
    if (start >= header->inner_nodes || is_free_node(&nodes[start])) return;
    uint ready = 0;
    for (uint side = 0; side < 2; ++side) {
        const uint child = child_of(&nodes[start], side);
        if (!is_leaf(child)) continue;
        store_child_box(&nodes[start], side, refit_leaves(positions, indices, leaves, child));
        ++ready;
    }
    uint index = start;
    while (ready != 0) {
        if (!both_children_ready(arrivals, index, ready)) return;
        global BvhNode* node = &nodes[index];
        const Box box = box_union(child_box(node, 0), child_box(node, 1));  // mutant: refit-union
        const uint parent = node->parent;
        if (parent == CLARAY_NO_CHILD) {
            store_header_box(header, box);
            return;
        }
        store_child_box(&nodes[parent], nodes[parent].child0 == index ? 0 : 1, box);
        index = parent;
        ready = 1;
    }
}
