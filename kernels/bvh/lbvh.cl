// Agglomerative linear BVH in one bottom-up pass (Apetrei 2014, "Fast and Simple Agglomerative LBVH Construction"):
// every leaf climbs; at a node the first child to arrive stops and the second continues with the union of both.
// Node i splits the leaves between i and i + 1, so that the numbering does not depend on the order of arrival.
//
// A work-group joins its own leaves in local memory as far as possible. So most nodes are written once and whole, and only the few
// subtrees at the group's borders need global memory and fences.
#include "bvh/radix_tree.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 256
#endif

/// A climbing subtree: leaves first .. last, and its parent.
typedef struct Climber {
    Box box;
    uint first, last, child, height;
    uint parent;  // the split on its left or right; CLARAY_NO_CHILD at the root
    bool is_left;  // child of its parent
} Climber;

static inline void look_up(Climber* c, global const Code* codes, uint valid) {
    if (c->last - c->first + 1 == valid) {
        c->parent = CLARAY_NO_CHILD;
        return;
    }
    c->is_left = parent_is_right(codes, c->first, c->last, valid);
    c->parent = c->is_left ? c->last : c->first - 1;
}

/// The same by the levels of a group's borders, which are in local memory: the border before leaf begin + i is the i-th.
static inline void look_up_in_group(Climber* c, local const uint* level, uint begin, uint valid) {
    c->is_left = level[c->last + 1 - begin] < level[c->first - begin];
    c->parent = c->last - c->first + 1 == valid ? CLARAY_NO_CHILD : c->is_left ? c->last : c->first - 1;
}

static inline uint height_count(const Climber* c) {
    return (c->height << 24) | min(c->last - c->first + 1, CLARAY_COUNT_LIMIT);
}

/// The data that waiting subtrees leave for their siblings, by work-item.
typedef struct Records {
    float lox[GROUP_SIZE], loy[GROUP_SIZE], loz[GROUP_SIZE], hix[GROUP_SIZE], hiy[GROUP_SIZE], hiz[GROUP_SIZE];
    uint end[GROUP_SIZE], child[GROUP_SIZE], height[GROUP_SIZE];
} Records;

static inline void store_record(local Records* records, uint item, const Climber* c) {
    records->lox[item] = c->box.lo.x, records->loy[item] = c->box.lo.y, records->loz[item] = c->box.lo.z;
    records->hix[item] = c->box.hi.x, records->hiy[item] = c->box.hi.y, records->hiz[item] = c->box.hi.z;
    records->end[item] = c->is_left ? c->first : c->last;
    records->child[item] = c->child, records->height[item] = c->height;
}

/// Joins the subtree with the sibling left by `item`: writes their node and continues as that node.
static inline void join_record(Climber* c, local const Records* records, uint item, local const uint* level,
                               uint begin, global BvhNode* nodes, uint valid) {
    const Box mine = c->box;
    const Box other = {(float3)(records->lox[item], records->loy[item], records->loz[item]),
                       (float3)(records->hix[item], records->hiy[item], records->hiz[item])};
    const uint index = c->parent, child = c->child, other_child = records->child[item];
    const bool is_left = c->is_left;
    if (is_left) c->last = records->end[item];
    else c->first = records->end[item];
    c->box = box_union(mine, other);
    const uint leaf = is_left ? joined_leaf(mine, child, other, other_child) : joined_leaf(other, other_child, mine, child);
    if (leaf != CLARAY_NO_CHILD) {
        c->child = leaf;
        look_up_in_group(c, level, begin, valid);
        store_free_node(&nodes[index]);
        return;
    }
    c->height = 1 + max(c->height, records->height[item]);
    c->child = index;
    look_up_in_group(c, level, begin, valid);
    if (is_left) store_node(&nodes[index], mine, other, child, other_child, c->parent, height_count(c));
    else store_node(&nodes[index], other, mine, other_child, child, c->parent, height_count(c));
}

/// Climbs while both children of the parent are in the group (leaves begin .. end - 1). Returns true if it waits in the group.
static inline bool climb_in_group(Climber* c, local Records* records, volatile local uint* arrivals, uint begin, uint end,
                                  local const uint* level, global BvhNode* nodes, uint valid) {
    const uint item = get_local_id(0);
    while (c->parent != CLARAY_NO_CHILD && c->parent >= begin && c->parent + 1 < end) {
        store_record(records, item, c);
        mem_fence(CLK_LOCAL_MEM_FENCE);
        const uint other = atomic_xchg(&arrivals[c->parent - begin], item);
        if (other == NO_ARRIVAL) return true;
        mem_fence(CLK_LOCAL_MEM_FENCE);
        join_record(c, records, other, level, begin, nodes, valid);
    }
    return false;
}

/// Climbs through global memory until it has to wait, or to the root.
static inline void climb(Climber* c, volatile global uint* arrivals, global const Code* codes, global BvhNode* nodes,
                         uint valid) {
    while (c->parent != CLARAY_NO_CHILD) {
        global BvhNode* node = &nodes[c->parent];
        const uint side = c->is_left ? 0 : 1;
        store_child_box(node, side, c->box);
        if (side == 0) node->child0 = c->child;
        else node->child1 = c->child;
        ((global uchar*)&node->height_count)[side] = (uchar)c->height;  // one byte each until both children have arrived

        // Releases the stores to the node and acquires the sibling's.
        const uint other_end = exchange_in_order(&arrivals[c->parent], c->is_left ? c->first : c->last);
        if (other_end == NO_ARRIVAL) return;

        if (c->is_left) c->last = other_end;
        else c->first = other_end;
        const Box other = child_box(node, side ^ 1);
        const uint other_child = child_of(node, side ^ 1);
        const uint leaf = side == 0 ? joined_leaf(c->box, c->child, other, other_child)
                                    : joined_leaf(other, other_child, c->box, c->child);
        c->box = box_union(c->box, other);
        if (leaf != CLARAY_NO_CHILD) {
            store_free_node(node);
            c->child = leaf;
            look_up(c, codes, valid);
            continue;
        }
        c->height = 1 + max(c->height, (uint)((global const uchar*)&node->height_count)[side ^ 1]);
        c->child = c->parent;
        look_up(c, codes, valid);
        node->parent = c->parent;
        node->height_count = height_count(c);
    }
}

/// `codes` are sorted; `order[i]` is the triangle of leaf i; `arrivals` holds NO_ARRIVAL for all nodes.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void build_lbvh(global const float* positions, global const uint* indices, global const uint* geometries,
                global const uint* masks, global const Code* codes, global const uint* order, global BvhNode* nodes,
                global LeafTriangle* leaves, volatile global uint* arrivals, global BvhHeader* header) {
    local Records records;
    local uint group_arrivals[GROUP_SIZE], level[GROUP_SIZE + 1];
    const uint item = get_local_id(0), leaf = get_global_id(0), valid = header->valid;
    const uint begin = leaf - item, end = min(begin + GROUP_SIZE, valid);
    group_arrivals[item] = NO_ARRIVAL;
    if (item == 0) level[0] = border(codes, begin - 1, valid);
    level[item + 1] = border(codes, leaf, valid);
    barrier(CLK_LOCAL_MEM_FENCE);

    Climber c;
    bool waits = false;
    if (leaf < valid) {
        const uint primitive = order[leaf];
        const Triangle triangle = load_triangle(positions, indices, primitive);
        store_leaf(&leaves[leaf], triangle, primitive, geometries, masks);
        c.box = box_of(triangle);
        c.first = c.last = leaf, c.child = CLARAY_LEAF | leaf, c.height = 0, c.is_left = false;
        look_up_in_group(&c, level, begin, valid);
        waits = climb_in_group(&c, &records, group_arrivals, begin, end, level, nodes, valid);
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    // An item is done if its sibling arrived meanwhile; otherwise the sibling comes from another group.
    if (leaf >= valid || (waits && group_arrivals[c.parent - begin] != item)) return;
    climb(&c, arrivals, codes, nodes, valid);
    if (c.parent == CLARAY_NO_CHILD) finish_tree(header, c.child, c.box, c.height);
}
