// Copies a finished binary tree into the order of traversal: nodes depth first, so that the first child follows its node, and
// leaves from left to right. Subtrees become leaves if that is cheaper by the surface area heuristic, and neighbouring parts of
// one triangle are merged. The numbering is the same on all devices. The copied leaves are references, of which only the
// primitive is used.
#include "bvh/sbvh/references.clh"

#ifndef MAX_LEAF
#define MAX_LEAF 1u  // triangles per leaf, up to 4
#endif
#define TREELET 32u  // leaves of a subtree that one item copies
#define LEAF_LIMIT 4u
#define MANY 0xffu

/// The subtree below a node, after leaves were formed.
typedef struct Subtree {
    uint nodes, slots;  // inner nodes (0: the node becomes a leaf), and triangles in its leaves
    float cost;         // area times 1 per pair of boxes and 1 per triangle
    uint height;
    uint unique;            // different triangles, or MANY
    uint held[LEAF_LIMIT];  // the leaves that hold them
} Subtree;

static inline uint nodes_below(global const Subtree* subtrees, uint child) {
    return is_leaf(child) ? 0 : subtrees[child].nodes;
}
static inline uint slots_below(global const Subtree* subtrees, uint child) {
    return is_leaf(child) ? CLARAY_LEAF_COUNT(child) : subtrees[child].slots;
}

// ---- upwards --------------------------------------------------------------------------------------------------------

static inline void hold(global const LeafTriangle* leaves, Subtree* tree, uint slot) {
    if (tree->unique == MANY) return;
    for (uint i = 0; i < tree->unique; ++i)
        if (leaves[tree->held[i]].primitive == leaves[slot].primitive) return;
    if (tree->unique == MAX_LEAF) tree->unique = MANY;
    else tree->held[tree->unique++] = slot;
}

static inline void add_child(global const LeafTriangle* leaves, global const Subtree* subtrees, Subtree* tree, uint child,
                             float area) {
    if (is_leaf(child)) {
        const uint count = CLARAY_LEAF_COUNT(child);
        tree->slots += count;
        tree->cost += area * (float)count;
        for (uint i = 0; i < count; ++i) hold(leaves, tree, (child & CLARAY_SLOT) + i);
        return;
    }
    global const Subtree* below = &subtrees[child];
    tree->nodes += below->nodes;
    tree->slots += below->slots;
    tree->cost += below->cost;
    tree->height = max(tree->height, below->height);
    if (below->unique == MANY) tree->unique = MANY;
    else
        for (uint i = 0; i < below->unique; ++i) hold(leaves, tree, below->held[i]);
}

static inline Subtree measure(global const BvhNode* node, global const LeafTriangle* leaves,
                              global const Subtree* subtrees) {
    const Box box0 = child_box(node, 0), box1 = child_box(node, 1);
    const float area = half_area(box_union(box0, box1));
    Subtree tree = {1, 0, area, 0, 0, {0, 0, 0, 0}};
    add_child(leaves, subtrees, &tree, node->child0, half_area(box0));
    add_child(leaves, subtrees, &tree, node->child1, half_area(box1));
    ++tree.height;
    if (tree.unique != MANY && area * (float)tree.unique <= tree.cost) {
        tree.nodes = tree.height = 0;
        tree.slots = tree.unique;
        tree.cost = area * (float)tree.unique;
    }
    return tree;
}

/// One item per node, upwards as in refit.cl. `arrivals` is zero before.
kernel void measure_subtrees(global const BvhNode* nodes, global const LeafTriangle* leaves, global Subtree* subtrees,
                             volatile global uint* arrivals, global const BvhHeader* header) {
    const uint start = get_global_id(0);
    if (start >= header->inner_nodes) return;
    uint ready = (is_leaf(nodes[start].child0) ? 1 : 0) + (is_leaf(nodes[start].child1) ? 1 : 0);
    for (uint index = start; ready != 0; ready = 1) {
        if (!both_children_ready(arrivals, index, ready)) return;
        subtrees[index] = measure(&nodes[index], leaves, subtrees);
        index = nodes[index].parent;
        if (index == CLARAY_NO_CHILD) return;
    }
}

// ---- downwards ------------------------------------------------------------------------------------------------------

/// The new place of a node or leaf.
typedef struct Place {
    uint child, at, slot, parent;
} Place;

static inline Place place_below(global const Subtree* subtrees, global const BvhNode* node, Place place, uint side) {
    Place below = {child_of(node, side), place.at + 1, place.slot, place.at};
    if (side == 1) {
        below.at += nodes_below(subtrees, node->child0);
        below.slot += slots_below(subtrees, node->child0);
    }
    return below;
}

static inline Place place_of(global const BvhNode* nodes, global const Subtree* subtrees, uint index) {
    Place place = {index, 0, 0, CLARAY_NO_CHILD};
    uint from_parent = 0;
    for (uint child = index, parent = nodes[index].parent; parent != CLARAY_NO_CHILD;
         child = parent, parent = nodes[parent].parent) {
        const Place root = {parent, 0, 0, CLARAY_NO_CHILD};
        const Place step = place_below(subtrees, &nodes[parent], root, nodes[parent].child0 == child ? 0 : 1);
        place.at += step.at;
        place.slot += step.slot;
        if (child == index) from_parent = step.at;
    }
    if (from_parent != 0) place.parent = place.at - from_parent;
    return place;
}

static inline uint new_reference(global const Subtree* subtrees, Place place) {
    const bool leaf = nodes_below(subtrees, place.child) == 0;
    return leaf ? leaf_reference(slots_below(subtrees, place.child), place.slot) : place.at;
}

typedef struct Target {
    global const float* positions;
    global const uint* indices;
    global const uint* geometries;
    global const uint* masks;
    global BvhNode* nodes;
    global LeafTriangle* leaves;
} Target;

static inline void copy_leaf(global const LeafTriangle* leaf, const Target* target, uint slot) {
    store_leaf(&target->leaves[slot], load_triangle(target->positions, target->indices, leaf->primitive), leaf->primitive,
               target->geometries, target->masks);
}

static inline void copy_leaves(global const LeafTriangle* leaves, global const Subtree* subtrees, Place place,
                               const Target* target) {
    if (is_leaf(place.child)) {
        for (uint i = 0; i < CLARAY_LEAF_COUNT(place.child); ++i)
            copy_leaf(&leaves[(place.child & CLARAY_SLOT) + i], target, place.slot + i);
        return;
    }
    global const Subtree* tree = &subtrees[place.child];
    for (uint i = 0; i < tree->slots; ++i) copy_leaf(&leaves[tree->held[i]], target, place.slot + i);
}

static inline void copy_node(global const BvhNode* nodes, global const Subtree* subtrees, Place place, Place below[2],
                             const Target* target) {
    global const BvhNode* node = &nodes[place.child];
    global BvhNode* copy = &target->nodes[place.at];
    for (uint side = 0; side < 2; ++side) {
        below[side] = place_below(subtrees, node, place, side);
        store_child_box(copy, side, child_box(node, side));
    }
    copy->child0 = new_reference(subtrees, below[0]);
    copy->child1 = new_reference(subtrees, below[1]);
    copy->parent = place.parent;
    global const Subtree* tree = &subtrees[place.child];
    copy->height_count = (min(tree->height, 255u) << 24) | min(tree->slots, CLARAY_COUNT_LIMIT);
}

/// One item copies a node with many leaves below, together with its children that are leaves, or a whole subtree of at most TREELET
/// triangles.
kernel void copy_tree(global const BvhNode* nodes, global const LeafTriangle* leaves, global const Subtree* subtrees,
                      global const BvhHeader* header, global const float* positions, global const uint* indices,
                      global const uint* geometries, global const uint* masks, global BvhNode* new_nodes,
                      global LeafTriangle* new_leaves) {
    const uint index = get_global_id(0);
    const Target target = {positions, indices, geometries, masks, new_nodes, new_leaves};
    if (header->inner_nodes == 0 && index < header->valid) copy_leaf(&leaves[index], &target, index);
    if (index >= header->inner_nodes) return;
    const uint parent = nodes[index].parent;
    const bool alone = subtrees[index].slots > TREELET;
    if (!alone && parent != CLARAY_NO_CHILD && subtrees[parent].slots <= TREELET) return;  // the parent's item copies it
    Place stack[CLARAY_MAX_HEIGHT + 1], place = place_of(nodes, subtrees, index);
    uint depth = 0;
    while (true) {
        if (nodes_below(subtrees, place.child) == 0) {
            copy_leaves(leaves, subtrees, place, &target);
        } else {
            Place below[2];
            copy_node(nodes, subtrees, place, below, &target);
            for (uint side = 2; side-- > 0;)
                if (!alone || is_leaf(below[side].child)) stack[depth++] = below[side];
        }
        if (depth == 0) return;
        place = stack[--depth];
    }
}

/// Updates the header for the copy.
kernel void finish_copy(global const BvhNode* nodes, global const Subtree* subtrees, global BvhHeader* header) {
    const uint root = header->root;
    if (get_global_id(0) != 0 || header->inner_nodes == 0) return;
    store_header_box(header, box_union(child_box(&nodes[root], 0), child_box(&nodes[root], 1)));
    header->valid = subtrees[root].slots;
    header->inner_nodes = subtrees[root].nodes;
    header->height = subtrees[root].height;
    header->root = subtrees[root].nodes == 0 ? leaf_reference(subtrees[root].slots, 0) : 0;
}
