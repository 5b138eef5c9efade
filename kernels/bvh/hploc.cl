// Hierarchical parallel locally-ordered clustering (Benthin et al. 2024, "H-PLOC"): subtrees climb the radix tree of the
// Morton codes as in lbvh.cl, but pass up clusters instead of one node. When two subtrees meet, the nearest clusters along the
// curve are merged until at most MAX_CLUSTERS are left; so clusters are merged by distance, not by code.
// On GPUs a warp handles a meeting; in the portable schedule a single work-item does. Both merge the same pairs.
#include "bvh/hploc.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 128
#endif

// A cluster keeps the number of its first leaf in the list where it was formed. A number is released at most once, when its cluster
// is the second of a merge, and then becomes the number of the new node. Therefore no counter is needed, node 0 exists if any node
// does, and the numbering is the same on all devices.
typedef struct Cluster {
    uint child;
    Box box;
    uint height_count;  // of the subtree, as in BvhNode
    uint number;        // a node's word for its parent holds the number until the parent is known
} Cluster;

static inline Cluster load_cluster(global const BvhNode* nodes, global const LeafTriangle* leaves, uint child) {
    Cluster cluster;
    cluster.child = child;
    cluster.box = box_of_child(nodes, leaves, child);
    cluster.height_count = is_leaf(child) ? CLARAY_LEAF_COUNT(child) : nodes[child].height_count;
    cluster.number = is_leaf(child) ? child & CLARAY_SLOT : nodes[child].parent;
    return cluster;
}

static inline uint pair_key(Box a, Box b, uint i_xor_j) {
    const Box both = box_union(a, b);
    const float3 extent = both.hi - both.lo;
    return PAIR_KEY(as_uint, extent.x, extent.y, extent.z, i_xor_j);
}

/// The height saturates: a tree higher than a traversal's stack is not used (see host/bvh).
static inline Cluster merge_clusters(global BvhNode* nodes, Cluster a, Cluster b) {
    const uint index = b.number - 1;  // leaf 0 stays in the first cluster, so that its number is never released
    Cluster merged;
    merged.child = index;
    merged.box = box_union(a.box, b.box);
    merged.number = a.number;
    const uint count = (a.height_count & CLARAY_COUNT_LIMIT) + (b.height_count & CLARAY_COUNT_LIMIT);
    const uint leaf = joined_leaf(a.box, a.child, b.box, b.child);
    if (leaf != CLARAY_NO_CHILD) {
        store_free_node(&nodes[index]);
        merged.child = leaf, merged.height_count = count;
        return merged;
    }
    const uint height = min(1 + max(a.height_count >> 24, b.height_count >> 24), 255u);
    merged.height_count = (height << 24) | min(count, CLARAY_COUNT_LIMIT);
    store_node(&nodes[index], a.box, b.box, a.child, b.child, a.number, merged.height_count);
    if (!is_leaf(a.child)) nodes[a.child].parent = index;
    if (!is_leaf(b.child)) nodes[b.child].parent = index;
    return merged;
}

static inline void finish_clusters(global BvhNode* nodes, global BvhHeader* header, Cluster root) {
    if (!is_leaf(root.child)) nodes[root.child].parent = CLARAY_NO_CHILD;
    finish_tree(header, root.child, root.box, root.height_count >> 24);
}

// ---- one work-item -------------------------------------------------------------------------------------------------

/// Appends the clusters of leaves first .. last to `list`.
static inline uint gather_clusters(global const BvhNode* nodes, global const LeafTriangle* leaves,
                                   global const uint* clusters, uint first, uint last, Cluster* list, uint count) {
    const uint most = min(last - first + 1, MAX_CLUSTERS);
    for (uint k = 0; k < most && clusters[first + k] != CLARAY_NO_CHILD; ++k)
        list[count++] = load_cluster(nodes, leaves, clusters[first + k]);
    return count;
}

/// Merges all pairs of mutual nearest neighbours; returns the number of remaining clusters, whose order is kept.
static inline uint merge_mutual(global BvhNode* nodes, Cluster* list, uint count) {
    uint keys[2 * MAX_CLUSTERS];
    for (uint i = 0; i < count; ++i) keys[i] = NO_PAIR;
    for (uint i = 0; i < count; ++i) {
        for (uint j = i + 1; j < min(count, i + SEARCH_RADIUS + 1); ++j) {
            const uint key = pair_key(list[i].box, list[j].box, i ^ j);
            keys[i] = min(keys[i], key);
            keys[j] = min(keys[j], key);
        }
    }
    uint left = 0;
    for (uint i = 0; i < count; ++i) {
        const uint other = i ^ (keys[i] & PAIR_INDEX);
        if (keys[other] != keys[i]) list[left++] = list[i];
        else if (i < other) list[left++] = merge_clusters(nodes, list[i], list[other]);
    }
    return left;
}

/// Joins leaves first .. split and split + 1 .. last, by one work-item.
static inline void meet(global BvhNode* nodes, global const LeafTriangle* leaves, global uint* clusters, uint first,
                        uint split, uint last, uint valid, global BvhHeader* header) {
    Cluster list[2 * MAX_CLUSTERS];
    uint count = gather_clusters(nodes, leaves, clusters, first, split, list, 0);
    count = gather_clusters(nodes, leaves, clusters, split + 1, last, list, count);
    const bool is_root = last - first + 1 == valid;
    while (count > (is_root ? 1 : MAX_CLUSTERS)) count = merge_mutual(nodes, list, count);
    if (is_root) {
        finish_clusters(nodes, header, list[0]);
        return;
    }
    for (uint k = 0; k < count; ++k) clusters[first + k] = list[k].child;
    if (count < MAX_CLUSTERS) clusters[first + count] = CLARAY_NO_CHILD;
}

// ---- one warp ------------------------------------------------------------------------------------------------------

#if CLARAY_USE_PTX

static inline float3 shuffle_float3(float3 v, uint lane) {
    return (float3)(warp_shuffle_float(v.x, lane), warp_shuffle_float(v.y, lane), warp_shuffle_float(v.z, lane));
}

static inline Box shuffle_box(Box box, uint lane) {
    const Box shuffled = {shuffle_float3(box.lo, lane), shuffle_float3(box.hi, lane)};
    return shuffled;
}

static inline Cluster shuffle_cluster(Cluster c, uint lane) {
    Cluster shuffled;
    shuffled.child = warp_shuffle(c.child, lane);
    shuffled.box = shuffle_box(c.box, lane);
    shuffled.height_count = warp_shuffle(c.height_count, lane);
    shuffled.number = warp_shuffle(c.number, lane);
    return shuffled;
}

/// A meeting of two subtrees: leaves first .. split and split + 1 .. last.
typedef struct Meeting {
    uint first, split, last;
} Meeting;

/// Half a warp reads the slots of the clusters of each side.
static inline uint slot_of_lane(Meeting m) {
    const uint lane = (uint)get_local_id(0) % WARP;
    return lane < MAX_CLUSTERS ? m.first + lane : m.split + 1 + lane - MAX_CLUSTERS;
}
static inline bool slot_in_meeting(Meeting m, uint slot) {
    return slot <= ((uint)get_local_id(0) % WARP < MAX_CLUSTERS ? m.split : m.last);
}

/// Counts the clusters of both sides from the child that each item found in its slot (CLARAY_NO_CHILD: none). `source` is the item
/// whose cluster this item takes over.
static inline uint close_ranks(uint child, uint* source) {
    const uint lane = (uint)get_local_id(0) % WARP;
    const uint missing = warp_ballot(child == CLARAY_NO_CHILD);
    const uint of_left = lowest_bit(missing | (1u << MAX_CLUSTERS));
    const uint missing_right = missing >> MAX_CLUSTERS;
    const uint of_right = missing_right != 0 ? lowest_bit(missing_right) : MAX_CLUSTERS;
    *source = lane < of_left ? lane : min(MAX_CLUSTERS + lane - of_left, WARP - 1);
    return of_left + of_right;
}

/// The key of each item's cluster and its nearest one among items 0 .. count - 1. Each pair is measured once, by its lower item.
/// Items beyond have no pair; lanes below zero wrap around to such items in the shuffle.
static inline uint nearest_in_warp(Box mine, uint count) {
    const uint lane = (uint)get_local_id(0) % WARP;
    uint best = NO_PAIR;
    #pragma unroll
    for (uint step = 1; step <= SEARCH_RADIUS; ++step) {
        const uint other = lane + step;
        uint key = pair_key(mine, shuffle_box(mine, other % WARP), lane ^ other);
        if (other >= count) key = NO_PAIR;
        best = min(best, min(key, warp_shuffle(key, (lane - step) % WARP)));
    }
    return best;
}

/// As merge_mutual with one cluster per item; returns the mask of items that still have one.
static inline uint merge_by_warp(global BvhNode* nodes, Cluster* mine, uint count) {
    const uint lane = (uint)get_local_id(0) % WARP, key = nearest_in_warp(mine->box, count);
    const uint nearest = lane ^ (key & PAIR_INDEX);
    const bool mutual = warp_shuffle(key, nearest) == key && lane < count, merges = mutual && lane < nearest;
    const Cluster other = shuffle_cluster(*mine, nearest);
    if (merges) *mine = merge_clusters(nodes, *mine, other);
    return warp_ballot(lane < count && (!mutual || merges));
}

/// Merges until the number of clusters that a meeting passes up is reached, or only the root is left. Returns the mask of items
/// that hold them, in order. `scratch` has one word of local memory per item of the warp.
static inline uint merge_to_limit(global BvhNode* nodes, Cluster* mine, uint count, bool is_root, local uint* scratch) {
    const uint lane = (uint)get_local_id(0) % WARP, limit = is_root ? 1 : MAX_CLUSTERS;
    uint holders = (uint)(((ulong)1 << count) - 1);
    while (count > limit) {
        if (holders >> (count - 1) != 1) {  // others are between them
            if (holders >> lane & 1) scratch[popcount(holders & ((1u << lane) - 1))] = lane;
            warp_barrier();
            const uint source = lane < count ? scratch[lane] : lane;
            warp_barrier();
            *mine = shuffle_cluster(*mine, source);
        }
        holders = merge_by_warp(nodes, mine, count);
        count = popcount(holders);
    }
    return holders;
}

/// meet, by a whole warp.
static inline void meet_by_warp(global BvhNode* nodes, global const LeafTriangle* leaves, global uint* clusters,
                                Meeting m, uint valid, global BvhHeader* header, local uint* scratch) {
    const uint lane = (uint)get_local_id(0) % WARP, slot = slot_of_lane(m);
    const uint child = slot_in_meeting(m, slot) ? clusters[slot] : CLARAY_NO_CHILD;
    uint source;
    uint count = close_ranks(child, &source);
    const uint gathered = warp_shuffle(child, source);
    Cluster mine;
    if (lane < count) mine = load_cluster(nodes, leaves, gathered);
    const bool is_root = m.last - m.first + 1 == valid;
    const uint holders = merge_to_limit(nodes, &mine, count, is_root, scratch);
    const bool holds = holders >> lane & 1;
    if (is_root) {
        if (holds) finish_clusters(nodes, header, mine);
    } else {
        if (holds) clusters[m.first + popcount(holders & ((1u << lane) - 1))] = mine.child;
        count = popcount(holders);
        if (lane == count && count < MAX_CLUSTERS) clusters[m.first + count] = CLARAY_NO_CHILD;
    }
    warp_barrier();  // the warp's stores precede the owner's next arrival
}

// ---- one work-group ------------------------------------------------------------------------------------------------
// Subtrees of a group's own leaves meet in local memory, which needs neither fences nor loads of nodes.

typedef struct GroupClusters {
    float lox[GROUP_SIZE], loy[GROUP_SIZE], loz[GROUP_SIZE], hix[GROUP_SIZE], hiy[GROUP_SIZE], hiz[GROUP_SIZE];
    uint child[GROUP_SIZE], height_count[GROUP_SIZE], number[GROUP_SIZE];
    uint level[GROUP_SIZE + 1];  // of the borders before each leaf and after the last
} GroupClusters;

static inline void store_in_group(local GroupClusters* group, uint i, Cluster c) {
    group->lox[i] = c.box.lo.x, group->loy[i] = c.box.lo.y, group->loz[i] = c.box.lo.z;
    group->hix[i] = c.box.hi.x, group->hiy[i] = c.box.hi.y, group->hiz[i] = c.box.hi.z;
    group->child[i] = c.child, group->height_count[i] = c.height_count, group->number[i] = c.number;
}

static inline Cluster load_from_group(local const GroupClusters* group, uint i) {
    Cluster c;
    c.box.lo = (float3)(group->lox[i], group->loy[i], group->loz[i]);
    c.box.hi = (float3)(group->hix[i], group->hiy[i], group->hiz[i]);
    c.child = group->child[i], c.height_count = group->height_count[i], c.number = group->number[i];
    return c;
}

/// meet_by_warp in local memory; `begin` is the group's first leaf.
static inline void meet_in_group(global BvhNode* nodes, local GroupClusters* group, uint begin, Meeting m, uint valid,
                                 global BvhHeader* header, local uint* scratch) {
    const uint lane = (uint)get_local_id(0) % WARP, slot = slot_of_lane(m);
    const uint child = slot_in_meeting(m, slot) ? group->child[slot - begin] : CLARAY_NO_CHILD;
    uint source;
    uint count = close_ranks(child, &source);
    const uint gathered = warp_shuffle(slot, source) - begin;
    Cluster mine;
    if (lane < count) mine = load_from_group(group, gathered);
    warp_barrier();  // all loads precede any store
    const bool is_root = m.last - m.first + 1 == valid;
    const uint holders = merge_to_limit(nodes, &mine, count, is_root, scratch);
    const bool holds = holders >> lane & 1;
    if (is_root) {
        if (holds) finish_clusters(nodes, header, mine);
    } else {
        if (holds) store_in_group(group, m.first - begin + popcount(holders & ((1u << lane) - 1)), mine);
        count = popcount(holders);
        if (lane == count && count < MAX_CLUSTERS) group->child[m.first - begin + count] = CLARAY_NO_CHILD;
    }
    warp_barrier();
}

/// Climbs from each leaf of the group (leaves begin .. end - 1) while both siblings are in the group. Returns true for an item that
/// must continue outside; `first` and `last` are then its subtree.
static inline bool climb_in_group(global BvhNode* nodes, local GroupClusters* group, volatile local uint* arrivals,
                                  uint begin, uint end, uint valid, global BvhHeader* header, local uint* scratch,
                                  uint* first, uint* last) {
    bool climbing = *first < end && valid > 1, outside = false, waits = false;
    uint split = 0, arrival = 0;
    while (true) {
        bool meets = false;
        if (climbing) {
            const bool right_neighbour = group->level[*last + 1 - begin] < group->level[*first - begin];
            split = right_neighbour ? *last : *first - 1;
            outside = split < begin || split + 1 >= end;
            climbing = !outside;
            if (climbing) {
                arrival = right_neighbour ? *first : *last;
                mem_fence(CLK_LOCAL_MEM_FENCE);
                const uint other_end = atomic_xchg(&arrivals[split - begin], arrival);
                waits = other_end == NO_ARRIVAL;
                climbing = !waits;
                if (climbing) {
                    mem_fence(CLK_LOCAL_MEM_FENCE);
                    if (right_neighbour) *last = other_end;
                    else *first = other_end;
                    const uint size = *last - *first + 1;
                    meets = size > MAX_CLUSTERS || size == valid;
                    climbing = size != valid;
                }
            }
        }
        for (uint waiting = warp_ballot(meets); waiting != 0; waiting &= waiting - 1) {
            const uint owner = lowest_bit(waiting);
            const Meeting m = {warp_shuffle(*first, owner), warp_shuffle(split, owner), warp_shuffle(*last, owner)};
            meet_in_group(nodes, group, begin, m, valid, header, scratch);
        }
        if (warp_ballot(climbing) == 0) break;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    // An item is done if its sibling arrived meanwhile; otherwise the sibling comes from another group.
    return outside || (waits && arrivals[split - begin] == arrival);
}

#endif

// ---- kernels -------------------------------------------------------------------------------------------------------

/// `codes` are sorted; `order[i]` is the triangle of leaf i; `arrivals` holds NO_ARRIVAL for all leaves but the last. Each item
/// climbs from its leaf as long as it arrives second.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void build_hploc(global const float* positions, global const uint* indices, global const uint* geometries,
                 global const uint* masks, global const Code* codes, global const uint* order, global BvhNode* nodes,
                 global LeafTriangle* leaves, volatile global uint* arrivals, global uint* clusters,
                 global BvhHeader* header) {
    const uint leaf = get_global_id(0), valid = header->valid;
    uint first = leaf, last = leaf, split = 0;
    bool climbing = leaf < valid && valid > 1;
#if CLARAY_USE_PTX
    local GroupClusters group;
    local uint group_arrivals[GROUP_SIZE], scratch_of_group[GROUP_SIZE];
    const uint item = get_local_id(0), begin = leaf - item, end = min(begin + GROUP_SIZE, valid);
    local uint* scratch = &scratch_of_group[item / WARP * WARP];
    group_arrivals[item] = NO_ARRIVAL;
    if (item == 0) group.level[0] = border(codes, begin - 1, valid);
    group.level[item + 1] = border(codes, leaf, valid);
#endif
    if (leaf < valid) {
        const uint primitive = order[leaf];
        const Triangle triangle = load_triangle(positions, indices, primitive);
        store_leaf(&leaves[leaf], triangle, primitive, geometries, masks);
        const Cluster cluster = {CLARAY_LEAF | leaf, box_of(triangle), 1, leaf};
        if (valid == 1) finish_tree(header, cluster.child, cluster.box, 0);
#if CLARAY_USE_PTX
        store_in_group(&group, item, cluster);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    climbing = climb_in_group(nodes, &group, group_arrivals, begin, end, valid, header, scratch, &first, &last);
    if (leaf < valid) clusters[leaf] = group.child[item];
    barrier(CLK_GLOBAL_MEM_FENCE);
#else
        clusters[leaf] = cluster.child;
    }
#endif
    while (true) {
        bool meets = false;
        if (climbing) {
            const bool right_neighbour = parent_is_right(codes, first, last, valid);
            split = right_neighbour ? last : first - 1;
            const uint other_end = exchange_in_order(&arrivals[split], right_neighbour ? first : last);
            climbing = other_end != NO_ARRIVAL;
            if (climbing) {
                if (right_neighbour) last = other_end;
                else first = other_end;
                const uint size = last - first + 1;
                meets = size > MAX_CLUSTERS || size == valid;
                climbing = size != valid;
            }
        }
#if CLARAY_USE_PTX
        // The warp handles the meetings of its items one after the other.
        for (uint waiting = warp_ballot(meets); waiting != 0; waiting &= waiting - 1) {
            const uint owner = lowest_bit(waiting);
            const Meeting m = {warp_shuffle(first, owner), warp_shuffle(split, owner), warp_shuffle(last, owner)};
            meet_by_warp(nodes, leaves, clusters, m, valid, header, scratch);
        }
        if (warp_ballot(climbing) == 0) break;
#else
        if (meets) meet(nodes, leaves, clusters, first, split, last, valid, header);
        if (!climbing) break;
#endif
    }
}
