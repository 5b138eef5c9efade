// The second pass of queries over a structure with cut-outs. The first pass treats all triangles as solid; its result is right for
// rays that hit a solid triangle, the opaque part of a triangle, or nothing. The other rays are traced again, one by one.
#ifndef CLARAY_CUTOUTS
#define CLARAY_CUTOUTS 1
#endif
#include "trace/closest_hit.clh"
#include "trace/query.clh"

/// Whether the triangle with this record is opaque where the first pass hit it. Its sides are not known here: triangles that are
/// invisible from behind are left to the second pass.
static inline bool hit_stands(global const uint* store, uint record, Ray ray, Hit hit) {
    if ((cutout_mode(store, record) & CLARAY_CUT_BACK) != 0) return false;
    const float3 origin = (float3)(ray.ox, ray.oy, ray.oz), direction = (float3)(ray.dx, ray.dy, ray.dz);
    return is_there(store, record, origin, direction, hit.primitive, hit.u, hit.v, false);
}

/// `hits` holds the results of the first pass, for the first min(capacity, *count) rays.
kernel QUERY_GROUP
void retrace_closest(CLARAY_BVH_PARAMETERS, global const Ray* rays, global Hit* hits, uint capacity,
                     global const uint* count, global const uint* masks) {
    const uint all = rays_to_trace(capacity, count);
    FOR_EACH_RAY(i, all) {
        const Hit hit = hits[i];
        if (hit.primitive == CLARAY_MISS) continue;
        const uint record = cutout_of(claray_cutouts, hit.primitive);
        if (record == CLARAY_NO_MAP || hit_stands(claray_cutouts, record, rays[i], hit)) continue;
        Visits unused = {0, 0};
        hits[i] = claray_trace(CLARAY_BVH, rays[i], false, CULL_BACK_FACES, mask_of_ray(masks, i), &unused);
    }
}

/// The same for any hit: a ray that hit something may have hit only cut-out parts.
kernel QUERY_GROUP
void retrace_any(CLARAY_BVH_PARAMETERS, global const Ray* rays, global uchar* occluded, uint capacity,
                 global const uint* count, global const uint* masks) {
    const uint all = rays_to_trace(capacity, count);
    FOR_EACH_RAY(i, all) {
        if (!occluded[i]) continue;
        Visits unused = {0, 0};
        const Hit hit = claray_trace(CLARAY_BVH, rays[i], true, CULL_BACK_FACES, mask_of_ray(masks, i), &unused);
        occluded[i] = hit.primitive != CLARAY_MISS;
    }
}
