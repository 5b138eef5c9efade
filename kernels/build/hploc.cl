// Hierarchical parallel locally-ordered clustering (Benthin et al. 2024, "H-PLOC"): subtrees climb the radix tree of the
// Morton codes as in lbvh.cl, but hand up clusters instead of one node. Where two meet, the nearest clusters along the
// curve are merged until at most MAX_CLUSTERS are left, so that what ends up together is near in space, not in code.
// GPUs let a warp work on one meeting place; the portable schedule lets a single work-item. Both merge the same pairs.
#include "build/radix_tree.clh"

/// Clusters that a subtree hands up: half a warp.
#define MAX_CLUSTERS 16u
/// How far along the curve a cluster looks for its nearest neighbour.
#define SEARCH_RADIUS 8u

typedef struct Cluster {
    uint child;
    Box box;
    uint height, count;  // of the subtree
} Cluster;

static inline Cluster load_cluster(global const BvhNode* nodes, global const LeafTriangle* leaves, uint child) {
    Cluster cluster;
    cluster.child = child;
    cluster.box = box_of_child(nodes, leaves, child);
    const uint height_count = is_leaf(child) ? 1 : nodes[child].height_count;
    cluster.height = height_count >> 24, cluster.count = height_count & CLARAY_COUNT_LIMIT;
    return cluster;
}

/// Area of the box round both, and the tie that prefers neighbours in pairs, so that equal clusters give a balanced tree.
static inline bool nearer(float area, uint distance, float best_area, uint best_distance) {
    return area < best_area || (area == best_area && distance < best_distance);
}

/// Height saturates: a tree higher than the stack of a traversal is not used (see host/build).
static inline Cluster merge_clusters(global BvhNode* nodes, uint index, Cluster a, Cluster b) {
    Cluster merged;
    merged.child = index;
    merged.box = box_union(a.box, b.box);
    merged.height = min(1 + max(a.height, b.height), 255u);
    merged.count = min(a.count + b.count, CLARAY_COUNT_LIMIT);
    store_node(&nodes[index], a.box, b.box, a.child, b.child, CLARAY_NO_CHILD, (merged.height << 24) | merged.count);
    if (!is_leaf(a.child)) nodes[a.child].parent = index;
    if (!is_leaf(b.child)) nodes[b.child].parent = index;
    return merged;
}

static inline void finish_clusters(global BvhNode* nodes, global BvhHeader* header, Cluster root) {
    if (!is_leaf(root.child)) nodes[root.child].parent = CLARAY_NO_CHILD;
    finish_tree(header, root.child, root.box, root.height);
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

/// Merges all pairs of mutual nearest neighbours; returns how many clusters are left, in the same order.
static inline uint merge_mutual(global BvhNode* nodes, volatile global uint* node_count, Cluster* list, uint count) {
    uint nearest[2 * MAX_CLUSTERS];
    for (uint i = 0; i < count; ++i) {
        float best_area = INFINITY;
        uint best = i;
        const uint end = min(count, i + SEARCH_RADIUS + 1);
        for (uint j = i > SEARCH_RADIUS ? i - SEARCH_RADIUS : 0; j < end; ++j) {
            if (j == i) continue;
            const float area = half_area(box_union(list[i].box, list[j].box));
            if (best == i || nearer(area, i ^ j, best_area, i ^ best)) best = j, best_area = area;
        }
        nearest[i] = best;
    }
    uint left = 0;
    for (uint i = 0; i < count; ++i) {
        const uint other = nearest[i];
        if (nearest[other] != i) list[left++] = list[i];
        else if (i < other) list[left++] = merge_clusters(nodes, atomic_inc(node_count), list[i], list[other]);
    }
    return left;
}

/// The meeting of leaves first .. split and split + 1 .. last, by one work-item.
static inline void meet(global BvhNode* nodes, global const LeafTriangle* leaves, global uint* clusters, uint first,
                        uint split, uint last, uint valid, volatile global uint* node_count, global BvhHeader* header) {
    Cluster list[2 * MAX_CLUSTERS];
    uint count = gather_clusters(nodes, leaves, clusters, first, split, list, 0);
    count = gather_clusters(nodes, leaves, clusters, split + 1, last, list, count);
    const bool is_root = last - first + 1 == valid;
    while (count > (is_root ? 1 : MAX_CLUSTERS)) count = merge_mutual(nodes, node_count, list, count);
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
    shuffled.height = warp_shuffle(c.height, lane);
    shuffled.count = warp_shuffle(c.count, lane);
    return shuffled;
}

/// Item k receives cluster k of both sides; returns their number.
static inline uint gather_by_warp(global const BvhNode* nodes, global const LeafTriangle* leaves,
                                  global const uint* clusters, uint first, uint split, uint last, Cluster* mine) {
    const uint lane = (uint)get_local_id(0) % WARP;
    const bool left = lane < MAX_CLUSTERS;
    const uint at = left ? first + lane : split + 1 + lane - MAX_CLUSTERS;
    const uint child = at <= (left ? split : last) ? clusters[at] : CLARAY_NO_CHILD;
    const uint missing = warp_ballot(child == CLARAY_NO_CHILD);
    const uint of_left = lowest_bit(missing | (1u << MAX_CLUSTERS));
    const uint missing_right = missing >> MAX_CLUSTERS;
    const uint of_right = missing_right != 0 ? lowest_bit(missing_right) : MAX_CLUSTERS;
    const uint source = lane < of_left ? lane : min(MAX_CLUSTERS + lane - of_left, WARP - 1);
    const uint gathered = warp_shuffle(child, source);
    if (lane < of_left + of_right) *mine = load_cluster(nodes, leaves, gathered);
    return of_left + of_right;
}

/// The nearest neighbour of each item's cluster: every pair is measured once, by its lower item.
static inline uint nearest_in_warp(Cluster mine, uint count) {
    const uint lane = (uint)get_local_id(0) % WARP;
    float best_area = INFINITY;
    uint best = lane;
    for (uint step = 1; step <= SEARCH_RADIUS; ++step) {
        const Box other = shuffle_box(mine.box, min(lane + step, WARP - 1));
        const float area = half_area(box_union(mine.box, other));
        if (lane + step < count && nearer(area, lane ^ (lane + step), best_area, lane ^ best))
            best = lane + step, best_area = area;
        const float area_before = warp_shuffle_float(area, lane >= step ? lane - step : lane);
        if (lane >= step && lane < count && nearer(area_before, lane ^ (lane - step), best_area, lane ^ best))
            best = lane - step, best_area = area_before;
    }
    return best;
}

/// As merge_mutual, a cluster an item. `scratch` is a word of local memory an item of the warp.
static inline uint merge_by_warp(global BvhNode* nodes, volatile global uint* node_count, Cluster* mine, uint count,
                                 local uint* scratch) {
    const uint lane = (uint)get_local_id(0) % WARP, below = (1u << lane) - 1;
    const uint nearest = nearest_in_warp(*mine, count);
    const bool mutual = warp_shuffle(nearest, nearest) == lane && lane < count && nearest != lane;
    const Cluster other = shuffle_cluster(*mine, nearest);
    const bool merges = mutual && lane < nearest;
    const uint merging = warp_ballot(merges);
    uint base = 0;
    if (lane == 0) base = atomic_add(node_count, popcount(merging));
    base = warp_shuffle(base, 0);
    if (merges) *mine = merge_clusters(nodes, base + popcount(merging & below), *mine, other);

    const bool keeps = lane < count && (!mutual || merges);
    const uint keeping = warp_ballot(keeps);
    if (keeps) scratch[popcount(keeping & below)] = lane;
    warp_barrier();
    const uint left = popcount(keeping);
    const uint source = lane < left ? scratch[lane] : lane;
    warp_barrier();
    *mine = shuffle_cluster(*mine, source);
    return left;
}

/// As meet, by a whole warp.
static inline void meet_by_warp(global BvhNode* nodes, global const LeafTriangle* leaves, global uint* clusters,
                                uint first, uint split, uint last, uint valid, volatile global uint* node_count,
                                global BvhHeader* header, local uint* scratch) {
    const uint lane = (uint)get_local_id(0) % WARP;
    Cluster mine;
    uint count = gather_by_warp(nodes, leaves, clusters, first, split, last, &mine);
    const bool is_root = last - first + 1 == valid;
    while (count > (is_root ? 1 : MAX_CLUSTERS)) count = merge_by_warp(nodes, node_count, &mine, count, scratch);
    if (is_root) {
        if (lane == 0) finish_clusters(nodes, header, mine);
    } else {
        if (lane < count) clusters[first + lane] = mine.child;
        if (lane == count && count < MAX_CLUSTERS) clusters[first + lane] = CLARAY_NO_CHILD;
    }
    warp_barrier();  // what the warp wrote comes before the owner's next arrival
}

#endif

// ---- kernels -------------------------------------------------------------------------------------------------------

/// Leaves, and a cluster of each.
kernel void begin_hploc(global const float* positions, global const uint* indices, global const uint* geometries,
                        global const uint* masks, global const uint* order, global LeafTriangle* leaves,
                        global uint* clusters, global BvhHeader* header) {
    const uint leaf = get_global_id(0), valid = header->valid;
    if (leaf >= valid) return;
    const Triangle triangle = load_triangle(positions, indices, order[leaf]);
    store_leaf(&leaves[leaf], triangle, order[leaf], geometries, masks);
    clusters[leaf] = CLARAY_LEAF | leaf;
    if (valid == 1) finish_tree(header, CLARAY_LEAF, box_of(triangle), 0);
}

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

/// `arrivals` holds NO_ARRIVAL for every leaf but the last, `node_count` is zero. Every item climbs from its leaf as long as
/// it is the second to arrive.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void build_hploc(global const Code* codes, global BvhNode* nodes, global const LeafTriangle* leaves,
                 volatile global uint* arrivals, global uint* clusters, volatile global uint* node_count,
                 global BvhHeader* header) {
#if CLARAY_USE_PTX
    local uint scratch[GROUP_SIZE];
#endif
    const uint leaf = get_global_id(0), valid = header->valid;
    uint first = leaf, last = leaf, split = 0;
    bool climbing = leaf < valid && valid > 1;
    while (true) {
        bool meets = false;
        if (climbing) {
            const bool right_neighbour = parent_is_right(codes, first, last, valid);
            split = right_neighbour ? last : first - 1;
            device_fence();
            const uint other_end = atomic_xchg(&arrivals[split], right_neighbour ? first : last);
            climbing = other_end != NO_ARRIVAL;
            if (climbing) {
                device_fence();
                if (right_neighbour) last = other_end;
                else first = other_end;
                const uint size = last - first + 1;
                meets = size > MAX_CLUSTERS || size == valid;
                climbing = size != valid;
            }
        }
#if CLARAY_USE_PTX
        // The warp goes from one meeting place of its items to the next.
        for (uint waiting = warp_ballot(meets); waiting != 0; waiting &= waiting - 1) {
            const uint owner = lowest_bit(waiting);
            meet_by_warp(nodes, leaves, clusters, warp_shuffle(first, owner), warp_shuffle(split, owner),
                         warp_shuffle(last, owner), valid, node_count, header,
                         &scratch[get_local_id(0) / WARP * WARP]);
        }
        if (warp_ballot(climbing) == 0) break;
#else
        if (meets) meet(nodes, leaves, clusters, first, split, last, valid, node_count, header);
        if (!climbing) break;
#endif
    }
}
