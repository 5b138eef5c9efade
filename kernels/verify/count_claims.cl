// Counts the triangles that each ray hits, by the exact step of kernels/trace/triangle.clh on all triangles near the ray. Its own
// traversal uses generous tests of boxes and triangles; they reject most of the thousands of triangles in large fans. A builder
// that splits triangles puts one into several leaves: it counts once.
#include "claray/shared/bvh_node.h"
#include "trace/triangle.clh"

/// Returns whether the ray may meet the box, by a test that allows for all its rounding errors.
static inline bool comes_near(float3 lo, float3 hi, float3 origin, float3 reciprocal) {
    const float3 room = (fabs(lo) + fabs(hi) + fabs(origin)) * 1e-6f;
    const float3 a = (lo - room - origin) * reciprocal, b = (hi + room - origin) * reciprocal;
    const float3 near = min(a, b), far = max(a, b);
    const float in = max(max(near.x, near.y), near.z), out = min(min(far.x, far.y), far.z);
    return in <= out + 1e-5f * (fabs(in) + fabs(out)) && out >= 0.0f;
}

/// Returns whether the ray may meet the triangle: in float32 it passes all edges on one side. Three roundings of the differences
/// and seven of each product are below 2e-6 of the lengths.
static inline bool passes_near(float3 origin, float3 direction, float along, float3 v0, float3 v1, float3 v2) {
    const float3 a = v0 - origin, b = v1 - origin, c = v2 - origin;
    const float la = length_of(a), lb = length_of(b), lc = length_of(c), room = 1e-5f * along;
    const float u = dot_product(direction, cross_product(b, c)), v = dot_product(direction, cross_product(c, a)), w = dot_product(direction, cross_product(a, b));
    const float du = room * lb * lc, dv = room * lc * la, dw = room * la * lb;
    return !((u > du || v > dv || w > dw) && (u < -du || v < -dv || w < -dw));
}

#define MOST_CLAIMS 32u  // the next ones are not compared with each other

/// Adds a primitive to those that claim the ray, unless it is one of them, and returns their number.
static inline uint add_claim(uint* claiming, uint count, uint primitive) {
    for (uint k = 0; k < min(count, MOST_CLAIMS); ++k)
        if (claiming[k] == primitive) return count;
    if (count < MOST_CLAIMS) claiming[count] = primitive;
    return count + 1;
}

kernel void count_claims(global const BvhHeader* header, global const BvhNode* nodes, global const LeafTriangle* leaves,
                         global const Ray* rays, uint count, global uint* claims) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const PreparedRay ray = prepare_ray(rays[i], false, 0xffffffffu);
    const float3 least = select((float3)(1e-30f), ray.direction, fabs(ray.direction) > 1e-30f);
    const float3 reciprocal = 1.0f / least;
    const float along = length_of(ray.direction);
    uint stack[CLARAY_MAX_HEIGHT + 1], depth = 0, claiming[MOST_CLAIMS], total = 0;
    if (header->root != CLARAY_NO_CHILD) stack[depth++] = header->root;
    while (depth != 0) {
        const uint current = stack[--depth];
        if ((current & CLARAY_LEAF) == 0) {
            global const BvhNode* n = &nodes[current];
            if (comes_near((float3)(n->lo0x, n->lo0y, n->lo0z), (float3)(n->hi0x, n->hi0y, n->hi0z), ray.origin, reciprocal))
                stack[depth++] = n->child0;
            if (comes_near((float3)(n->lo1x, n->lo1y, n->lo1z), (float3)(n->hi1x, n->hi1y, n->hi1z), ray.origin, reciprocal))
                stack[depth++] = n->child1;
            continue;
        }
        const uint first = current & CLARAY_SLOT, end = first + CLARAY_LEAF_COUNT(current);
        for (uint slot = first; slot < end; ++slot) {
            global const LeafTriangle* l = &leaves[slot];
            const float3 v0 = {l->v0x, l->v0y, l->v0z}, v1 = {l->v1x, l->v1y, l->v1z}, v2 = {l->v2x, l->v2y, l->v2z};
            if (!passes_near(ray.origin, ray.direction, along, v0, v1, v2)) continue;
            Hit hit = no_hit(rays[i].tmax);
            if (exact_hit(&ray, v0, v1, v2, 0, 0, &hit)) total = add_claim(claiming, total, l->primitive);
        }
    }
    claims[i] = total;
}
