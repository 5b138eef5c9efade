// Closest hits by one plain loop over the binary tree. Triangle test, box test, node precision and arithmetic can be exchanged, so
// that times and errors of two variants differ only by the part that was exchanged.
#include "compute/portable.clh"
#ifndef CONTRACT
#define CONTRACT 0  // 1: the compiler may fuse multiplications and additions, the default of OpenCL C
#endif
#if CONTRACT
#pragma OPENCL FP_CONTRACT ON
#endif

#ifndef TRIANGLE_TEST
#define TRIANGLE_TEST 0  // see triangle_tests.clh
#endif
#define BOX_WIDENED 0  // plane / d - origin / d, widened by a bound on its error: trace/packets/slabs.clh, as claray's binary tree
#define BOX_PADDED 1   // (plane - origin) / d, the far distance padded by BOX_PAD: trace/box.clh, as claray's wide tree
#define BOX_IZE 2      // the same, padded by 2 ulp (Ize 2013)
#define BOX_FUSED 4    // fma(plane, 1 / d, -origin / d), without a pad; 3 is BOX_PADDED without a pad
#ifndef BOX_TEST
#define BOX_TEST BOX_WIDENED
#endif
#ifndef NODE_BITS
#define NODE_BITS 32  // of a plane: 32, or 16 or 8 on a grid of the node's own
#endif

#include "trace/traverse_binary.clh"
#include "trace/query.clh"
#if TRIANGLE_TEST != 0
#include "accuracy/triangle_tests.clh"
#endif
#if NODE_BITS != 32
#include "accuracy/quantize_nodes.clh"
#define NODE uint
#else
#define NODE BvhNode
#define NODE_WORDS 1
#endif

// ---- boxes ---------------------------------------------------------------------------------------------------------

/// Both children's planes: lower and upper of the first, lower and upper of the second.
typedef struct Boxes {
    float4 x, y, z;
    uint2 children;
} Boxes;

static inline Boxes boxes_of(global const NODE* nodes, uint index) {
    Boxes boxes;
    global const NODE* node = nodes + (size_t)index * NODE_WORDS;
#if NODE_BITS == 32
    global const float4* rows = (global const float4*)node;
    const float4 xy0 = rows[0], xy1 = rows[1];
    boxes.x = (float4)(xy0.xy, xy1.xy), boxes.y = (float4)(xy0.zw, xy1.zw), boxes.z = rows[2];
    boxes.children = as_uint2(rows[3].xy);
#else
    boxes.x = planes_of(node, 0), boxes.y = planes_of(node, 1), boxes.z = planes_of(node, 2);
    boxes.children = children_of(node);
#endif
    return boxes;
}

#if BOX_TEST == BOX_WIDENED
typedef Slabs BoxRay;
static inline bool enter_box(const BoxRay* slabs, float tbest, float2 x, float2 y, float2 z, float* enter) {
    int bits;
    const bool met = meets_box(slabs, tbest, x.x, x.y, y.x, y.y, z.x, z.y, ANY_SIGNS, &bits);
    *enter = as_float(bits);
    return met;
}
#else
typedef PreparedRay BoxRay;
#if BOX_TEST == BOX_PADDED
#define PAD (1.0f + 2.0f * GAMMA(7))  // mutant: study-box-pad
#elif BOX_TEST == BOX_IZE
#define PAD 1.00000024f
#else
#define PAD 1.0f
#endif
static inline float2 slab(float2 planes, float origin, float reciprocal) {
#if BOX_TEST == BOX_FUSED
    const float2 t = fma(planes, (float2)(reciprocal), (float2)(-origin * reciprocal));
#else
    const float2 t = (planes - origin) * reciprocal;
#endif
    return reciprocal < 0.0f ? t.yx : t;
}
static inline bool enter_box(const BoxRay* ray, float tbest, float2 x, float2 y, float2 z, float* enter) {
    const float2 tx = slab(x, ray->origin.x, ray->reciprocal.x), ty = slab(y, ray->origin.y, ray->reciprocal.y);
    const float2 tz = slab(z, ray->origin.z, ray->reciprocal.z);
    // Minima and maxima that drop NaN, as in trace/box.clh.
    const float in = fmax(fmax(fmax(ray->tmin, tx.x), ty.x), tz.x), out = fmin(fmin(fmin(tbest, tx.y), ty.y), tz.y);
    *enter = in;
    return in <= out * PAD;
}
#endif

// ---- leaves --------------------------------------------------------------------------------------------------------

#if TRIANGLE_TEST == 0
typedef Candidate Best;
#define FARTHEST(best) (best).far
static inline void try_triangles(const PreparedRay* ray, global const LeafTriangle* leaves, uint leaf, Best* best, Visits* visits) {
    const uint first = leaf & CLARAY_SLOT, end = first + CLARAY_LEAF_COUNT(leaf);
    if (CLARAY_COUNT_VISITS) visits->triangles += end - first;
    for (uint slot = first; slot < end; ++slot) try_leaf(ray, leaves, slot, best);
}
#else
typedef Hit Best;
#define FARTHEST(best) (best).t
static inline void try_triangles(const PreparedRay* ray, global const LeafTriangle* leaves, uint leaf, Best* best, Visits* visits) {
    if (CLARAY_COUNT_VISITS) visits->triangles += CLARAY_LEAF_COUNT(leaf);
    const uint first = leaf & CLARAY_SLOT, end = first + CLARAY_LEAF_COUNT(leaf);
    for (uint slot = first; slot < end; ++slot) {
        global const float4* rows = (global const float4*)&leaves[slot];
        const float4 a = rows[0], b = rows[1], c = rows[2];
        const Met met = meet_triangle(ray, a.xyz, b.xyz, c.xyz);
        const uint primitive = as_uint(a.w);
        if (!met.hit || !(met.t > ray->tmin && (met.t < best->t || (met.t == best->t && primitive < best->primitive)))) continue;
        best->t = met.t, best->u = met.u, best->v = met.v, best->primitive = primitive, best->geometry = as_uint(b.w);
    }
}
#endif

// ---- the loop ------------------------------------------------------------------------------------------------------

static CLARAY_OUTLINED Hit trace_variant_ray(global const BvhHeader* header, global const NODE* nodes, global const LeafTriangle* leaves,
                                    const PreparedRay* ray, float tmax, Visits* visits) {
#if BOX_TEST == BOX_WIDENED
    const Slabs box_ray = prepare_slabs(ray, header);
#else
    const PreparedRay box_ray = *ray;
#endif
#if TRIANGLE_TEST == 0
    Best best = no_candidate(tmax);
#else
    Best best = no_hit(tmax);
#endif
    uint stack[CLARAY_MAX_HEIGHT + 1];
    uint depth = 1, current = header->root;
    stack[0] = CLARAY_NO_CHILD;
    float enter;
    if (CLARAY_COUNT_VISITS) ++visits->nodes;
    if (!enter_box(&box_ray, tmax, (float2)(header->lox, header->hix), (float2)(header->loy, header->hiy),
                   (float2)(header->loz, header->hiz), &enter))
        current = CLARAY_NO_CHILD;
    while (current != CLARAY_NO_CHILD) {
        if ((current & CLARAY_LEAF) != 0) {
            try_triangles(ray, leaves, current, &best, visits);
            current = stack[--depth];
            continue;
        }
        if (CLARAY_COUNT_VISITS) visits->nodes += 2;
        const Boxes boxes = boxes_of(nodes, current);
        float enter0, enter1;
        const bool meets0 = enter_box(&box_ray, FARTHEST(best), boxes.x.lo, boxes.y.lo, boxes.z.lo, &enter0);
        const bool meets1 = enter_box(&box_ray, FARTHEST(best), boxes.x.hi, boxes.y.hi, boxes.z.hi, &enter1);
        const bool first0 = meets0 && (!meets1 || enter0 <= enter1);
        if (meets0 && meets1) stack[depth++] = first0 ? boxes.children.y : boxes.children.x;
        current = first0 ? boxes.children.x : meets1 ? boxes.children.y : stack[--depth];
    }
#if TRIANGLE_TEST == 0
    return finish_candidate(ray, leaves, best, tmax, false);
#else
    return best;
#endif
}

kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void trace_variant(global const BvhHeader* header, global const NODE* nodes, global const LeafTriangle* leaves,
                   global const Ray* rays, uint count, global Hit* hits, global Visits* visits) {
    FOR_EACH_RAY(i, count) {
        const Ray ray = rays[i];
        Visits visited = {0, 0};
        Hit hit = no_hit(ray.tmax);
        if (ray_valid(ray)) {
            const PreparedRay prepared = prepare_ray(ray, false, 0xffffffffu);
            hit = trace_variant_ray(header, nodes, leaves, &prepared, ray.tmax, &visited);
        }
        hits[i] = hit;
        if (CLARAY_COUNT_VISITS) visits[i] = visited;
    }
}
