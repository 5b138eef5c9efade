// Closest hit and any hit among those that a program's filter accepts (each_hit.clh).
#include "trace/lists/each_hit.clh"
#include "trace/query.clh"

static inline void find_accepted(CLARAY_BVH_PARAMETERS, Ray ray, uint mask, HitList* list FILTER_PARAMETER) {
    if (!ray_valid(ray)) return;
    PreparedRay prepared = prepare_ray(ray, CULL_BACK_FACES, mask);
    SET_CUTOUTS(&prepared, 0);
    find_each_hit(CLARAY_BVH, &prepared, list FILTER_ARGUMENT);
}

/// As closest_hit. `masks` is read under CLARAY_RAY_MASKS.
kernel QUERY_GROUP
void closest_accepted(CLARAY_BVH_PARAMETERS, global const Ray* rays, uint capacity, global const uint* count,
                      global const uint* masks FILTER_PARAMETER, global Hit* hits) {
    FOR_EACH_RAY(i, rays_to_trace(capacity, count)) {
        HitList list = {hits + i, 1, true, 0, rays[i].tmax, false};
        find_accepted(CLARAY_BVH, rays[i], mask_of_ray(masks, i), &list FILTER_ARGUMENT);
        if (list.count == 0) hits[i] = no_hit(rays[i].tmax);
    }
}

/// As any_hit.
kernel QUERY_GROUP
void any_accepted(CLARAY_BVH_PARAMETERS, global const Ray* rays, uint capacity, global const uint* count,
                  global const uint* masks FILTER_PARAMETER, global uchar* occluded) {
    FOR_EACH_RAY(i, rays_to_trace(capacity, count)) {
        HitList list = {0, 0, false, 0, rays[i].tmax, true};
        find_accepted(CLARAY_BVH, rays[i], mask_of_ray(masks, i), &list FILTER_ARGUMENT);
        occluded[i] = list.count != 0;
    }
}
