// The nearest point of the surface for each of an array of points.
//
// Triangles are tested in float64, four at once in the wide tree. Of all triangles whose distance, rounded to float32, is the least,
// the lowest primitive wins. Therefore the answer depends neither on the tree nor on the order of the search.
#include "trace/points/nearest_point.clh"
#include "trace/query.clh"

#ifndef BRUTE_FORCE
#define BRUTE_FORCE 0  // 1: tests every triangle, without the tree; binary layout only
#endif

/// A point in the order of the search.
static inline uint ordered(global const uint* order, uint i) { return order ? order[i] : i; }

/// Answers points order[0] .. order[count - 1], or 0 .. count - 1 if `order` is absent. `masks` is read under CLARAY_RAY_MASKS,
/// `visits` written under CLARAY_COUNT_VISITS. An item answers RAYS_PER_ITEM points, one after another: the answer to one bounds the
/// distance of the next.
kernel QUERY_GROUP
void nearest_point(CLARAY_BVH_PARAMETERS, global const float* points, global NearestPoint* nearest, uint count, float reach,
                   global const uint* order, global const uint* masks, global Visits* visits) {
    FOR_EACH_RAY(i, count) {
        const uint mine = ordered(order, i);
        const float3 at = vload3(mine, points);
        float start = reach;
        if (CLARAY_RAY_MASKS == 0 && i != first) start = reach_by_neighbour(at, &nearest[ordered(order, i - 1)], reach);
        Visits visited = {0, 0};
        const NearestPoint found = find_nearest(CLARAY_BVH, at, start, mask_of_ray(masks, mine), BRUTE_FORCE, &visited);
        nearest[mine] = found;
        if (found.primitive == CLARAY_MISS) nearest[mine].distance = reach;
        if (CLARAY_COUNT_VISITS) visits[mine] = visited;
    }
}

/// Keys by which neighbouring points are near each other: Morton codes in the structure's box, enlarged by half on each side. Points
/// outside belong to the cells of the border.
kernel void point_keys(global const BvhHeader* header, global const float* points, uint count, global uint* keys) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 lo = (float3)(header->lox, header->loy, header->loz), hi = (float3)(header->hix, header->hiy, header->hiz);
    const float side = 2.0f * fmax(fmax(hi.x - lo.x, hi.y - lo.y), hi.z - lo.z);
    const float3 cell = (vload3(i, points) - 0.5f * (lo + hi)) / side + 0.5f;
    const uint3 c = convert_uint3(clamp(cell, 0.0f, 0.9999f) * 1024.0f);  // NaN becomes some cell
    keys[i] = morton30(c.x & 1023u, c.y & 1023u, c.z & 1023u);
}
