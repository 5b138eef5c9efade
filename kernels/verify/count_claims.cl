// How many triangles claim each ray: the exact step of kernels/trace/triangle.clh on all that the ray comes near, by a
// traversal of its own with generous boxes.
#include "claray/shared/bvh_node.h"
#include "trace/triangle.clh"

/// Whether the ray may meet the box, by a test with room for all its roundings.
static inline bool comes_near(float3 lo, float3 hi, float3 origin, float3 direction) {
    const float3 room = (fabs(lo) + fabs(hi) + fabs(origin)) * 1e-6f;
    float in = -INFINITY, out = INFINITY;
    const float3 low = lo - room - origin, high = hi + room - origin;
    const float d[3] = {direction.x, direction.y, direction.z};
    const float l[3] = {low.x, low.y, low.z}, h[3] = {high.x, high.y, high.z};
    for (uint axis = 0; axis < 3; ++axis) {
        if (fabs(d[axis]) < 1e-30f) {
            if (l[axis] > 0.0f || h[axis] < 0.0f) return false;
            continue;
        }
        const float a = l[axis] / d[axis], b = h[axis] / d[axis];
        in = fmax(in, fmin(a, b)), out = fmin(out, fmax(a, b));
    }
    return in <= out + 1e-5f * (fabs(in) + fabs(out)) && out >= 0.0f;
}

kernel void count_claims(global const BvhHeader* header, global const BvhNode* nodes, global const LeafTriangle* leaves,
                         global const Ray* rays, uint count, global uint* claims) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const PreparedRay ray = prepare_ray(rays[i], false, 0xffffffffu);
    uint stack[CLARAY_MAX_HEIGHT + 1], depth = 0, total = 0;
    if (header->root != CLARAY_NO_CHILD) stack[depth++] = header->root;
    while (depth != 0) {
        const uint current = stack[--depth];
        if ((current & CLARAY_LEAF) == 0) {
            global const BvhNode* n = &nodes[current];
            if (comes_near((float3)(n->lo0x, n->lo0y, n->lo0z), (float3)(n->hi0x, n->hi0y, n->hi0z), ray.origin, ray.direction))
                stack[depth++] = n->child0;
            if (comes_near((float3)(n->lo1x, n->lo1y, n->lo1z), (float3)(n->hi1x, n->hi1y, n->hi1z), ray.origin, ray.direction))
                stack[depth++] = n->child1;
            continue;
        }
        const uint first = current & CLARAY_SLOT, end = first + CLARAY_LEAF_COUNT(current);
        for (uint slot = first; slot < end; ++slot) {
            global const LeafTriangle* l = &leaves[slot];
            Hit hit = no_hit(rays[i].tmax);
            total += exact_hit(&ray, (float3)(l->v0x, l->v0y, l->v0z), (float3)(l->v1x, l->v1y, l->v1z),
                               (float3)(l->v2x, l->v2y, l->v2z), 0, 0, &hit);
        }
    }
    claims[i] = total;
}
