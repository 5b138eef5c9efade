// Checks a finished binary tree: every leaf once, boxes contain, links point back; and measures its SAH cost.
#include "build/triangles.clh"

static inline bool contains(Box outer, Box inner) {
    return all(outer.lo <= inner.lo) && all(inner.hi <= outer.hi);
}

static inline bool child_in_range(uint child, uint valid) {
    return is_leaf(child) ? (child & CLARAY_SLOT) < valid : child + 1 < valid;
}

/// One item a node. `seen` counts the leaves of every triangle; `failures` holds {boxes not containing, links broken}.
/// All are zero before.
kernel void validate_nodes(global const BvhNode* nodes, global const LeafTriangle* leaves,
                           global const BvhHeader* header, uint triangles, volatile global uint* seen,
                           volatile global uint* failures) {
    const uint index = get_global_id(0), valid = header->valid;
    if (valid == 1 && index == 0) atomic_inc(&seen[leaves[0].primitive]);
    if (valid < 2 || index + 1 >= valid) return;
    for (uint side = 0; side < 2; ++side) {
        const uint child = child_of(&nodes[index], side);
        if (!child_in_range(child, valid)) {
            atomic_inc(&failures[1]);
            continue;
        }
        if (!contains(child_box(&nodes[index], side), box_of_child(nodes, leaves, child))) atomic_inc(&failures[0]);
        if (is_leaf(child)) {
            const uint primitive = leaves[child & CLARAY_SLOT].primitive;
            if (primitive < triangles) atomic_inc(&seen[primitive]);
            else atomic_inc(&failures[1]);
        } else if (nodes[child].parent != index) {
            atomic_inc(&failures[1]);
        }
    }
    if (nodes[index].parent == CLARAY_NO_CHILD && header->root != index) atomic_inc(&failures[1]);
}

/// One item a triangle: a valid one must be in the tree once, another never. Counts into {missing, repeated}.
kernel void validate_leaves(global const float* positions, global const uint* indices, uint triangles,
                            global const uint* seen, volatile global uint* failures) {
    const uint i = get_global_id(0);
    if (i >= triangles) return;
    const uint expected = triangle_valid(load_triangle(positions, indices, i)) ? 1 : 0;
    if (seen[i] < expected) atomic_inc(&failures[0]);
    if (seen[i] > expected) atomic_inc(&failures[1]);
}

/// Sums half the areas of nodes and of leaves, strided by item, into sums[2 * item] and sums[2 * item + 1]: adding them up
/// in order on the host gives the same cost every time.
kernel void sum_areas(global const BvhNode* nodes, global const BvhHeader* header, global float* sums) {
    const uint item = get_global_id(0), valid = header->valid;
    float of_nodes = 0.0f, of_leaves = 0.0f;
    for (uint i = item; i + 1 < valid; i += get_global_size(0)) {
        of_nodes += half_area(box_union(child_box(&nodes[i], 0), child_box(&nodes[i], 1)));
        for (uint side = 0; side < 2; ++side)
            if (is_leaf(child_of(&nodes[i], side))) of_leaves += half_area(child_box(&nodes[i], side));
    }
    sums[2 * item] = of_nodes;
    sums[2 * item + 1] = of_leaves;
}
