// Whether each ray of an array hits anything.
#include "trace/closest_hit.clh"
#include "trace/query.clh"

/// As the kernel closest_hit; writes 1 for a hit and 0 for none.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void any_hit(CLARAY_BVH_PARAMETERS, global const Ray* rays, global uchar* occluded, uint capacity,
             global const uint* count, global const uint* masks) {
    const uint i = get_global_id(0);
    if (i >= rays_to_trace(capacity, count)) return;
    Visits unused = {0, 0};
    const Hit hit = claray_trace(CLARAY_BVH, rays[i], true, CULL_BACK_FACES, mask_of_ray(masks, i), &unused);
    occluded[i] = hit.primitive != CLARAY_MISS;
}
