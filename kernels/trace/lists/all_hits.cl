// All hits of each ray: their number, a list of them, or the nearest of them in order.
#include "trace/lists/each_hit.clh"
#include "trace/query.clh"

/// Without `hits`: counts[i] is the number of hits of ray i; a split triangle counts once a part. With `offsets`: writes them in the
/// order of the search to hits[offsets[i]] .. hits[offsets[i + 1] - 1]. Otherwise: writes the `nearest` nearest hits in order, from
/// hits[i * nearest] on, and their number to counts[i]. `masks` is read under CLARAY_RAY_MASKS.
kernel QUERY_GROUP
void collect_hits(CLARAY_BVH_PARAMETERS, global const Ray* rays, uint count, global const uint* masks FILTER_PARAMETER, global const uint* offsets,
                  uint nearest, global Hit* hits, global uint* counts) {
    FOR_EACH_RAY(i, count) {
        const Ray ray = rays[i];
        const ulong begin = offsets ? offsets[i] : (ulong)i * nearest;
        HitList list = {hits ? hits + begin : 0, offsets ? offsets[i + 1] - offsets[i] : nearest, hits && !offsets, 0, ray.tmax, false};
        if (ray_valid(ray) && !(list.nearest && nearest == 0)) {
            PreparedRay prepared = prepare_ray(ray, CULL_BACK_FACES, mask_of_ray(masks, i));
            SET_CUTOUTS(&prepared, 0);
            find_each_hit(CLARAY_BVH, &prepared, &list FILTER_ARGUMENT);
        }
        counts[i] = list.count;
    }
}
