// The first hit of every ray of an array.
#include "trace/closest_hit.clh"
#include "trace/query.clh"

/// Traces the first min(capacity, *count) rays, or all where `count` is absent. `masks` and `visits` are read and written
/// where the macros CLARAY_RAY_MASKS and CLARAY_COUNT_VISITS say so.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void closest_hit(CLARAY_BVH_PARAMETERS, global const Ray* rays, global Hit* hits, uint capacity,
                 global const uint* count, global const uint* masks, global Visits* visits) {
    const uint i = get_global_id(0);
    if (i >= rays_to_trace(capacity, count)) return;
    Visits visited = {0, 0};
    hits[i] = claray_trace(CLARAY_BVH, rays[i], false, CULL_BACK_FACES, mask_of_ray(masks, i), &visited);
    if (CLARAY_COUNT_VISITS) visits[i] = visited;
}
