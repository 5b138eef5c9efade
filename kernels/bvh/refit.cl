// Recomputes the boxes of a tree along stored parents. The nodes of a group have consecutive numbers, so that most subtrees are in
// one group: these are joined in local memory, without fences, and their nodes written once. Only the rest climbs as in lbvh.cl;
// with groups of one item, as on CPUs, all nodes do.
#include "bvh/triangles.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 256
#endif

/// The box of a leaf whose triangle is no longer valid: no ray hits it, and it does not change a union.
static inline Box refit_leaf(global const float* positions, global const uint* indices, global LeafTriangle* leaf) {
    global float4* rows = (global float4*)leaf;  // a struct of scalars would be stored word by word
    const float4 row0 = rows[0], row1 = rows[1], row2 = rows[2];
    const Triangle t = load_triangle(positions, indices, as_uint(row0.w));
    rows[0] = (float4)(t.v0, row0.w), rows[1] = (float4)(t.v1, row1.w), rows[2] = (float4)(t.v2, row2.w);
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

/// Climbs through global memory: `ready` boxes of a node have been stored. A node waits for its other child, as in lbvh.cl. Parents are
/// read a level ahead, so that no level waits for memory more often than it must.
static inline void climb(global BvhNode* nodes, uint index, uint ready, volatile global uint* arrivals, global BvhHeader* header) {
    uint parent = nodes[index].parent, above = CLARAY_NO_CHILD;
    bool is_first = false;
    if (parent != CLARAY_NO_CHILD) is_first = nodes[parent].child0 == index, above = nodes[parent].parent;
    while (both_children_ready(arrivals, index, ready)) {
        uint4 references = (uint4)(CLARAY_NO_CHILD);  // child0, child1, parent
        if (above != CLARAY_NO_CHILD) references = ((global const uint4*)&nodes[above])[3];
        const Box box = box_union(child_box(&nodes[index], 0), child_box(&nodes[index], 1));  // mutant: refit-union
        if (parent == CLARAY_NO_CHILD) {
            store_header_box(header, box);
            return;
        }
        store_child_box(&nodes[parent], is_first ? 0 : 1, box);
        is_first = references.x == parent, index = parent, parent = above, above = references.z, ready = 1;
    }
}

#if GROUP_SIZE == 1
/// One item per node, in groups of any size. It computes the boxes of the node's leaves. `arrivals` is zero before.
kernel void refit_nodes(global const float* positions, global const uint* indices, global BvhNode* nodes,
                        global LeafTriangle* leaves, volatile global uint* arrivals, global BvhHeader* header) {
    const uint index = get_global_id(0);
    if (header->inner_nodes == 0 && index == 0 && header->valid != 0)
        store_header_box(header, refit_leaves(positions, indices, leaves, header->root));
    if (index >= header->inner_nodes || is_free_node(&nodes[index])) return;
    uint ready = 0;
    for (uint side = 0; side < 2; ++side) {
        const uint child = child_of(&nodes[index], side);
        if (!is_leaf(child)) continue;
        store_child_box(&nodes[index], side, refit_leaves(positions, indices, leaves, child));
        ++ready;
    }
    if (ready != 0) climb(nodes, index, ready, arrivals, header);
}
#else
/// A group's nodes: the boxes of their children, whose bits are set in `known` once they are there.
typedef struct GroupNodes {
    float lox[2][GROUP_SIZE], loy[2][GROUP_SIZE], loz[2][GROUP_SIZE], hix[2][GROUP_SIZE], hiy[2][GROUP_SIZE], hiz[2][GROUP_SIZE];
    uint parent[GROUP_SIZE], child0[GROUP_SIZE], known[GROUP_SIZE];
} GroupNodes;

#define BOTH_KNOWN 3u

static inline void put_box(local GroupNodes* group, uint side, uint item, Box box) {
    group->lox[side][item] = box.lo.x, group->loy[side][item] = box.lo.y, group->loz[side][item] = box.lo.z;
    group->hix[side][item] = box.hi.x, group->hiy[side][item] = box.hi.y, group->hiz[side][item] = box.hi.z;
}

static inline Box group_box(local const GroupNodes* group, uint side, uint item) {
    const Box box = {(float3)(group->lox[side][item], group->loy[side][item], group->loz[side][item]),
                     (float3)(group->hix[side][item], group->hiy[side][item], group->hiz[side][item])};
    return box;
}

static inline Box union_in_group(local const GroupNodes* group, uint item) {
    return box_union(group_box(group, 0, item), group_box(group, 1, item));
}

/// Announces the boxes of `sides` of node `item`, and climbs from there while both boxes are known and the parent is in the group,
/// whose nodes are `count` from `begin` on.
static inline void climb_in_group(local GroupNodes* group, uint begin, uint count, uint item, uint sides) {
    for (;;) {
        mem_fence(CLK_LOCAL_MEM_FENCE);
        const uint before = atomic_or((volatile local uint*)&group->known[item], sides);
        if ((before | sides) != BOTH_KNOWN) return;
        mem_fence(CLK_LOCAL_MEM_FENCE);
        const uint parent = group->parent[item] - begin;  // wraps around for parents before the group
        if (parent >= count) return;
        const uint side = group->child0[parent] == begin + item ? 0 : 1;
        put_box(group, side, parent, union_in_group(group, item));
        item = parent, sides = 1u << side;
    }
}

/// Writes what the group knows of a node, and continues where that needs other groups.
static inline void leave_group(local const GroupNodes* group, uint begin, uint count, uint item, global BvhNode* nodes,
                               volatile global uint* arrivals, global BvhHeader* header) {
    const uint known = group->known[item], index = begin + item, parent = group->parent[item];
    for (uint side = 0; side < 2; ++side)
        if ((known >> side & 1) != 0) store_child_box(&nodes[index], side, group_box(group, side, item));
    if (known == 0) return;
    if (known != BOTH_KNOWN) {
        climb(nodes, index, 1, arrivals, header);
        return;
    }
    if (parent == CLARAY_NO_CHILD) store_header_box(header, union_in_group(group, item));
    if (parent == CLARAY_NO_CHILD || parent - begin < count) return;
    store_child_box(&nodes[parent], nodes[parent].child0 == index ? 0 : 1, union_in_group(group, item));
    climb(nodes, parent, 1, arrivals, header);
}

/// One item per node. It computes the boxes of the node's leaves. `arrivals` is zero before.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void refit_nodes(global const float* positions, global const uint* indices, global BvhNode* nodes,
                 global LeafTriangle* leaves, volatile global uint* arrivals, global BvhHeader* header) {
    local GroupNodes group;
    const uint item = get_local_id(0), index = get_global_id(0), begin = index - item, inner = header->inner_nodes;
    const uint count = begin < inner ? min(inner - begin, (uint)GROUP_SIZE) : 0;
    if (inner == 0 && index == 0 && header->valid != 0)
        store_header_box(header, refit_leaves(positions, indices, leaves, header->root));
    uint sides = 0;
    const bool is_used = item < count && !is_free_node(&nodes[index]);
    group.known[item] = 0;
    if (is_used) {
        const uint4 references = ((global const uint4*)&nodes[index])[3];  // child0, child1, parent
        group.child0[item] = references.x, group.parent[item] = references.z;
        for (uint side = 0; side < 2; ++side) {
            const uint child = side == 0 ? references.x : references.y;
            if (!is_leaf(child)) continue;
            put_box(&group, side, item, refit_leaves(positions, indices, leaves, child));
            sides |= 1u << side;
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (sides != 0) climb_in_group(&group, begin, count, item, sides);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (is_used) leave_group(&group, begin, count, item, nodes, arrivals, header);
}
#endif
