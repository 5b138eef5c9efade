// A better tree by reinsertion: every node looks for the place where the sum of the tree's box areas would gain most if the
// node were moved there, and all moves that don't disturb each other are made at once (Meister and Bittner 2018,
// "Parallel Reinsertion for Bounding Volume Hierarchy Optimization").
//
// Nodes and leaves are the same on all devices and numbered alike (bvh/layout.cl sees to that); every choice below is by
// gain and then by number, so the result is the same everywhere too. A node or leaf is named by its child reference, and
// counted by its id: inner nodes first, then leaves.
#include "bvh/triangles.clh"

/// Nodes that one search looks at: what lies further is rarely found and makes the others wait.
#ifndef SEARCH_LIMIT
#define SEARCH_LIMIT 1024u
#endif
#define SEARCH_STACK 64u

#define NO_MOVE 0xffffffffu

/// A move that was found: `child` to become the sibling of `target`. `pivot` is their lowest common ancestor, or the
/// target if that is itself an ancestor.
typedef struct Move {
    uint target, pivot;
    uint gain;  // bits of the area saved, whose order is that of the areas; 0: no move
    uint wins;  // 1: holds all that it changes
} Move;

static inline uint id_of(uint child, uint inner) { return is_leaf(child) ? inner + (child & CLARAY_SLOT) : child; }

static inline uint child_of_id(uint id, uint inner) { return id < inner ? id : CLARAY_LEAF | (id - inner); }

static inline uint parent_of(global const BvhNode* nodes, global const uint* leaf_parents, uint child) {
    return is_leaf(child) ? leaf_parents[child & CLARAY_SLOT] : nodes[child].parent;
}

static inline uint side_of(global const BvhNode* node, uint child) { return node->child0 == child ? 0 : 1; }

/// One item a node.
kernel void find_leaf_parents(global const BvhNode* nodes, global uint* leaf_parents, global const BvhHeader* header) {
    const uint index = get_global_id(0);
    if (index >= header->inner_nodes) return;
    for (uint side = 0; side < 2; ++side) {
        const uint child = child_of(&nodes[index], side);
        if (is_leaf(child)) leaf_parents[child & CLARAY_SLOT] = index;
    }
}

// ---- the search -----------------------------------------------------------------------------------------------------

typedef struct Search {
    Box box;    // of the node to be moved
    float area;
    float best;  // the largest gain so far
    uint target, pivot;
    uint looked;
} Search;

/// The node would become the sibling of `child`: `budget` is what its removal saves, less what the boxes above `child`
/// grow. Returns the same for the children of `child`.
static inline float try_target(Search* search, uint child, Box box, float budget, uint pivot) {
    const float grown = half_area(box_union(box, search->box));
    if (budget - grown > search->best) {
        search->best = budget - grown;
        search->target = child;
        search->pivot = pivot;
    }
    return budget - (grown - half_area(box));
}

/// Everything below `top`, branch and bound: no place below a node saves more than its budget less the moved node's area.
static inline void search_below(global const BvhNode* nodes, Search* search, uint top, float top_budget, uint pivot) {
    uint stack[SEARCH_STACK];
    float budgets[SEARCH_STACK];
    uint depth = 0, current = top;
    float budget = top_budget;
    while (true) {
        const bool promising = !is_leaf(current) && budget - search->area > search->best;
        if (promising && search->looked < SEARCH_LIMIT) {
            ++search->looked;
            global const BvhNode* node = &nodes[current];
            const uint child0 = node->child0, child1 = node->child1;
            const float budget0 = try_target(search, child0, child_box(node, 0), budget, pivot);
            const float budget1 = try_target(search, child1, child_box(node, 1), budget, pivot);
            const bool first0 = budget0 >= budget1;
            if (depth < SEARCH_STACK) {
                stack[depth] = first0 ? child1 : child0;
                budgets[depth++] = first0 ? budget1 : budget0;
            }
            current = first0 ? child0 : child1;
            budget = first0 ? budget0 : budget1;
        } else {
            if (depth == 0) return;
            current = stack[--depth];
            budget = budgets[depth];
        }
    }
}

/// One item a node or leaf; of each `stride` in a row only number `phase` searches. From the node's parent up to the root,
/// the subtree of every sibling on the way is searched.
kernel void find_moves(global const BvhNode* nodes, global const uint* leaf_parents, global const BvhHeader* header,
                       uint stride, uint phase, global Move* moves) {
    const uint id = get_global_id(0), inner = header->inner_nodes;
    if (inner < 3 || id >= 2 * inner + 1) return;
    moves[id].gain = moves[id].wins = 0;
    if (id % stride != phase) return;
    const uint child = child_of_id(id, inner);
    const uint parent = parent_of(nodes, leaf_parents, child);
    if (parent == CLARAY_NO_CHILD || nodes[parent].parent == CLARAY_NO_CHILD) return;

    const uint side = side_of(&nodes[parent], child);
    Search search;
    search.box = child_box(&nodes[parent], side);
    search.area = half_area(search.box);
    search.best = 0.0f;
    search.target = NO_MOVE;
    search.pivot = NO_MOVE;
    search.looked = 0;
    Box rest = child_box(&nodes[parent], side ^ 1);  // what stays of the ancestor without the node
    float saved = half_area(box_union(search.box, rest));
    const uint sibling = child_of(&nodes[parent], side ^ 1);
    search_below(nodes, &search, sibling, try_target(&search, sibling, rest, saved, parent), parent);
    uint below = parent;
    for (uint pivot = nodes[parent].parent; pivot != CLARAY_NO_CHILD; pivot = nodes[pivot].parent) {
        const uint below_side = side_of(&nodes[pivot], below), other = child_of(&nodes[pivot], below_side ^ 1);
        const Box with = child_box(&nodes[pivot], below_side), other_box = child_box(&nodes[pivot], below_side ^ 1);
        search_below(nodes, &search, other, try_target(&search, other, other_box, saved, pivot), pivot);
        rest = box_union(rest, other_box);
        saved += half_area(box_union(with, other_box)) - half_area(rest);
        if (nodes[pivot].parent != CLARAY_NO_CHILD) try_target(&search, pivot, rest, saved, pivot);
        below = pivot;
    }
    if (search.target == NO_MOVE) return;
    moves[id].target = search.target;
    moves[id].pivot = search.pivot;
    moves[id].gain = as_uint(search.best);
}

// ---- who may move ---------------------------------------------------------------------------------------------------

/// The six whose links a move changes: the node, its parent, grandparent and sibling, the target and its parent.
static inline void changed_by(global const BvhNode* nodes, global const uint* leaf_parents, uint inner, uint id,
                              uint target, uint changed[6]) {
    const uint child = child_of_id(id, inner), parent = parent_of(nodes, leaf_parents, child);
    changed[0] = id;
    changed[1] = parent;
    changed[2] = nodes[parent].parent;
    changed[3] = id_of(child_of(&nodes[parent], side_of(&nodes[parent], child) ^ 1), inner);
    changed[4] = id_of(target, inner);
    changed[5] = parent_of(nodes, leaf_parents, target);
}

/// Each node learns the largest gain among the moves that would change it; `gains` is zero before.
kernel void claim_by_gain(global const BvhNode* nodes, global const uint* leaf_parents, global const BvhHeader* header,
                          global const Move* moves, volatile global uint* gains) {
    const uint id = get_global_id(0), inner = header->inner_nodes;
    if (inner < 3 || id >= 2 * inner + 1 || moves[id].gain == 0) return;
    uint changed[6];
    changed_by(nodes, leaf_parents, inner, id, moves[id].target, changed);
    for (uint i = 0; i < 6; ++i) atomic_max(&gains[changed[i]], moves[id].gain);
}

static inline bool has_largest_gain(const uint changed[6], uint gain, global const uint* gains) {
    for (uint i = 0; i < 6; ++i)
        if (gains[changed[i]] != gain) return false;
    return true;
}

/// Of equal gains the lowest id; `owners` holds all ones before.
kernel void claim_by_id(global const BvhNode* nodes, global const uint* leaf_parents, global const BvhHeader* header,
                        global const Move* moves, global const uint* gains, volatile global uint* owners) {
    const uint id = get_global_id(0), inner = header->inner_nodes;
    if (inner < 3 || id >= 2 * inner + 1 || moves[id].gain == 0) return;
    uint changed[6];
    changed_by(nodes, leaf_parents, inner, id, moves[id].target, changed);
    if (!has_largest_gain(changed, moves[id].gain, gains)) return;
    for (uint i = 0; i < 6; ++i) atomic_min(&owners[changed[i]], id);
}

kernel void find_winners(global const BvhNode* nodes, global const uint* leaf_parents, global const BvhHeader* header,
                         global Move* moves, global const uint* gains, global const uint* owners) {
    const uint id = get_global_id(0), inner = header->inner_nodes;
    if (inner < 3 || id >= 2 * inner + 1 || moves[id].gain == 0) return;
    uint changed[6];
    changed_by(nodes, leaf_parents, inner, id, moves[id].target, changed);
    bool wins = has_largest_gain(changed, moves[id].gain, gains);
    for (uint i = 0; wins && i < 6; ++i) wins = owners[changed[i]] == id;
    moves[id].wins = wins;
}

/// Two winners could each move into the other's subtree, and so cut both off from the root. A winner gives way to a
/// better one that moves an ancestor of its target, up to the common ancestor. That is enough: in a cycle of moves each
/// target lies below the next node to be moved; leave out every node that lies below the next one itself, which is carried
/// along; for the others the next one is such an ancestor, so gains would have to fall all the way round the cycle.
/// `moves[id].wins` becomes 2 for those that stay.
kernel void prevent_cycles(global const BvhNode* nodes, global const uint* leaf_parents, global const BvhHeader* header,
                           global Move* moves) {
    const uint id = get_global_id(0), inner = header->inner_nodes;
    if (inner < 3 || id >= 2 * inner + 1 || moves[id].wins == 0) return;
    const uint gain = moves[id].gain, pivot = moves[id].pivot;
    for (uint child = moves[id].target; child != pivot; child = parent_of(nodes, leaf_parents, child)) {
        const uint other = id_of(child, inner);
        if (moves[other].wins == 0) continue;
        if (moves[other].gain > gain || (moves[other].gain == gain && other < id)) return;
    }
    moves[id].wins = 2;
}

// ---- moving ---------------------------------------------------------------------------------------------------------

static inline void set_child(global BvhNode* node, uint side, uint child, Box box) {
    if (side == 0) node->child0 = child;
    else node->child1 = child;
    store_child_box(node, side, box);
}

static inline void set_parent(global BvhNode* nodes, global uint* leaf_parents, uint child, uint parent) {
    if (is_leaf(child)) leaf_parents[child & CLARAY_SLOT] = parent;
    else nodes[child].parent = parent;
}

/// The node's parent leaves the tree, its sibling takes the parent's place, and the parent comes back between the target and
/// the target's parent. Boxes of inner nodes are put right by update_nodes.
kernel void apply_moves(global BvhNode* nodes, global uint* leaf_parents, global const BvhHeader* header,
                        global const Move* moves) {
    const uint id = get_global_id(0), inner = header->inner_nodes;
    if (inner < 3 || id >= 2 * inner + 1 || moves[id].wins != 2) return;
    const uint child = child_of_id(id, inner), parent = parent_of(nodes, leaf_parents, child);
    const uint side = side_of(&nodes[parent], child), grandparent = nodes[parent].parent;
    const uint sibling = child_of(&nodes[parent], side ^ 1);
    set_child(&nodes[grandparent], side_of(&nodes[grandparent], parent), sibling, child_box(&nodes[parent], side ^ 1));
    set_parent(nodes, leaf_parents, sibling, grandparent);

    const uint target = moves[id].target, above = parent_of(nodes, leaf_parents, target);
    const uint target_side = side_of(&nodes[above], target);
    const Box target_box = child_box(&nodes[above], target_side);
    set_child(&nodes[above], target_side, parent, box_union(target_box, child_box(&nodes[parent], side)));
    nodes[parent].parent = above;
    set_child(&nodes[parent], side ^ 1, target, target_box);
    set_parent(nodes, leaf_parents, target, parent);
}

/// Boxes, heights and counts from the leaves' boxes, as refit.cl does from the triangles. `arrivals` is zero before. One item a
/// node.
kernel void update_nodes(global BvhNode* nodes, volatile global uint* arrivals, global BvhHeader* header) {
    const uint start = get_global_id(0);
    if (start >= header->inner_nodes) return;
    uint ready = (is_leaf(nodes[start].child0) ? 1 : 0) + (is_leaf(nodes[start].child1) ? 1 : 0);
    for (uint index = start; ready != 0; ready = 1) {
        if (!both_children_ready(arrivals, index, ready)) return;
        global BvhNode* node = &nodes[index];
        uint height = 0, count = 0;
        for (uint side = 0; side < 2; ++side) {
            const uint child = child_of(node, side), below = is_leaf(child) ? 1 : nodes[child].height_count;
            height = max(height, below >> 24);
            count += below & CLARAY_COUNT_LIMIT;
        }
        height = min(height + 1, 255u);
        node->height_count = (height << 24) | min(count, CLARAY_COUNT_LIMIT);
        const uint parent = node->parent;
        if (parent == CLARAY_NO_CHILD) {
            header->root = index;
            header->height = height;
            return;
        }
        store_child_box(&nodes[parent], side_of(&nodes[parent], index), box_union(child_box(node, 0), child_box(node, 1)));
        index = parent;
    }
}
