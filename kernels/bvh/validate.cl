// Checks a finished binary tree (each triangle is in a leaf, or in parts that cover it; boxes contain their subtrees; links point
// back), measures its SAH cost, and finds out whether the triangles close.
#include "bvh/triangles.clh"

static inline bool contains(Box outer, Box inner) {
    return all(outer.lo <= inner.lo) && all(inner.hi <= outer.hi);
}

static inline bool child_in_range(global const BvhNode* nodes, uint child, global const BvhHeader* header) {
    if (is_leaf(child)) return (child & CLARAY_SLOT) + CLARAY_LEAF_COUNT(child) <= header->valid;
    return child < header->inner_nodes && !is_free_node(&nodes[child]);
}

static inline bool overlap(Box a, Box b) { return all(a.lo <= b.hi) && all(b.lo <= a.hi); }

/// Counts of a triangle in `seen`: leaves whose boxes contain all of it, and leaves with a part of it.
#define SEEN_WHOLE 0x10000u
#define SEEN_PART 1u

/// A leaf's box must overlap its triangle's box, or a part of it if the triangle was split.
static inline void see_leaf(global const LeafTriangle* leaf, Box box, uint triangles, volatile global uint* seen,
                            volatile global uint* failures) {
    if (leaf->primitive >= triangles) {
        atomic_inc(&failures[1]);
        return;
    }
    const Box whole = box_of(leaf_triangle(leaf));
    if (contains(box, whole)) atomic_add(&seen[leaf->primitive], SEEN_WHOLE);
    else if (overlap(whole, box)) atomic_add(&seen[leaf->primitive], SEEN_PART);
    else atomic_inc(&failures[0]);
}

/// One item per node. `seen` counts the leaves of each triangle; `failures` holds {boxes not containing, links broken}.
/// All are zero before.
kernel void validate_nodes(global const BvhNode* nodes, global const LeafTriangle* leaves,
                           global const BvhHeader* header, uint triangles, volatile global uint* seen,
                           volatile global uint* failures) {
    const uint index = get_global_id(0), inner = header->inner_nodes;
    if (inner == 0 && index == 0 && header->valid != 0) {
        const uint root = header->root;
        if (!is_leaf(root) || (root & CLARAY_SLOT) != 0 || CLARAY_LEAF_COUNT(root) != header->valid) atomic_inc(&failures[1]);
        for (uint i = 0; i < header->valid; ++i)
            see_leaf(&leaves[i], box_of(leaf_triangle(&leaves[i])), triangles, seen, failures);
    }
    if (index >= inner || is_free_node(&nodes[index])) return;
    for (uint side = 0; side < 2; ++side) {
        const uint child = child_of(&nodes[index], side);
        const Box box = child_box(&nodes[index], side);
        if (!child_in_range(nodes, child, header)) {
            atomic_inc(&failures[1]);
        } else if (is_leaf(child)) {
            for (uint i = 0; i < CLARAY_LEAF_COUNT(child); ++i)
                see_leaf(&leaves[(child & CLARAY_SLOT) + i], box, triangles, seen, failures);
        } else {
            if (!contains(box, box_of_child(nodes, leaves, child))) atomic_inc(&failures[0]);
            if (nodes[child].parent != index) atomic_inc(&failures[1]);
        }
    }
    if (nodes[index].parent == CLARAY_NO_CHILD && header->root != index) atomic_inc(&failures[1]);
}

/// Returns whether a leaf of the triangle is reached from the root through boxes that contain the point to within `slack`.
static inline bool reaches(global const BvhNode* nodes, global const LeafTriangle* leaves, global const BvhHeader* header,
                           uint primitive, float3 point, float3 slack) {
    uint stack[2 * CLARAY_MAX_HEIGHT], depth = 0;
    stack[depth++] = header->root;
    while (depth != 0) {
        const uint current = stack[--depth];
        if (!child_in_range(nodes, current, header) || depth + 2 > 2 * CLARAY_MAX_HEIGHT) return false;
        if (is_leaf(current)) {
            for (uint i = 0; i < CLARAY_LEAF_COUNT(current); ++i)
                if (leaves[(current & CLARAY_SLOT) + i].primitive == primitive) return true;
            continue;
        }
        for (uint side = 0; side < 2; ++side) {
            const Box box = child_box(&nodes[current], side);
            if (all(box.lo - slack <= point) && all(point <= box.hi + slack)) stack[depth++] = child_of(&nodes[current], side);
        }
    }
    return false;
}

/// Tests points of the triangle: a grid of barycentric sixths.
static inline bool covered(global const BvhNode* nodes, global const LeafTriangle* leaves, global const BvhHeader* header,
                           uint primitive, Triangle t) {
    const float3 rounding = 4.8e-7f * fmax(fmax(fabs(t.v0), fabs(t.v1)), fabs(t.v2));  // of the points' own coordinates
    for (uint i = 0; i <= 6; ++i)
        for (uint j = 0; i + j <= 6; ++j) {
            const bool corner = i == 6 || j == 6 || i + j == 0;
            const float u = (float)i / 6.0f, v = (float)j / 6.0f;
            float3 point = t.v0 * (1.0f - u - v) + t.v1 * u + t.v2 * v;
            if (corner) point = i == 6 ? t.v1 : j == 6 ? t.v2 : t.v0;
            if (!reaches(nodes, leaves, header, primitive, point, corner ? (float3)(0.0f) : rounding)) return false;
        }
    return true;
}

/// One item per triangle: a valid one must be in the tree once, or in parts that cover it; others never. Counts into
/// {missing, repeated, not covered}.
kernel void validate_leaves(global const float* positions, global const uint* indices, uint triangles,
                            global const BvhNode* nodes, global const LeafTriangle* leaves,
                            global const BvhHeader* header, global const uint* seen, volatile global uint* failures) {
    const uint i = get_global_id(0);
    if (i >= triangles) return;
    const Triangle triangle = load_triangle(positions, indices, i);
    const uint whole = seen[i] / SEEN_WHOLE, parts = seen[i] % SEEN_WHOLE;
    const bool expected = triangle_valid(triangle);
    if (expected && seen[i] == 0) atomic_inc(&failures[0]);
    const bool split = header->valid + header->culled > triangles;  // then a box may contain more than its part
    if (expected ? !split && whole + parts > 1 : seen[i] != 0) atomic_inc(&failures[1]);
    if (expected && whole == 0 && parts != 0 && !covered(nodes, leaves, header, i, triangle))
        atomic_inc(&failures[2]);
}

/// Sums half the areas of nodes and of leaves, strided by item, into sums[2 * item] and sums[2 * item + 1]. The host adds them in
/// order, so that the cost is the same in every run.
kernel void sum_areas(global const BvhNode* nodes, global const BvhHeader* header, global float* sums) {
    const uint item = get_global_id(0), inner = header->inner_nodes;
    float of_nodes = 0.0f, of_leaves = 0.0f;
    for (uint i = item; i < inner; i += get_global_size(0)) {
        if (is_free_node(&nodes[i])) continue;
        of_nodes += half_area(box_union(child_box(&nodes[i], 0), child_box(&nodes[i], 1)));
        for (uint side = 0; side < 2; ++side)
            if (is_leaf(child_of(&nodes[i], side)))
                of_leaves += half_area(child_box(&nodes[i], side)) * (float)CLARAY_LEAF_COUNT(child_of(&nodes[i], side));
    }
    sums[2 * item] = of_nodes;
    sums[2 * item + 1] = of_leaves;
}

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014).
static inline ulong mixed(ulong x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ul;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebul;
    return x ^ (x >> 31);
}

static inline ulong hash_of_vertex(float3 v) {
    const ulong xy = (ulong)as_uint(v.x) << 32 | as_uint(v.y);
    return mixed(mixed(xy + 0x9e3779b97f4a7c15ul) + as_uint(v.z));
}

static inline ulong hash_of_edge(ulong a, ulong b) { return mixed(a + b); }

/// Combines the hashes of all edges by exclusive or, in two words: edges that an even number of triangles share cancel. Vertices are
/// the same if their coordinates are. The sums are 0 if the surface is closed, and else with a chance of 2^-64.
kernel void sum_edges(global const float* positions, global const uint* indices, uint count, volatile global uint* sums) {
    ulong sum = 0;
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        const Triangle t = load_triangle(positions, indices, i);
        if (!triangle_valid(t)) continue;
        const ulong a = hash_of_vertex(t.v0), b = hash_of_vertex(t.v1), c = hash_of_vertex(t.v2);
        sum ^= hash_of_edge(a, b) ^ hash_of_edge(b, c) ^ hash_of_edge(c, a);
    }
    atomic_xor(&sums[0], (uint)sum);
    atomic_xor(&sums[1], (uint)(sum >> 32));
}
