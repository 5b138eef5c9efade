// Tests every ray against every triangle, without the tree: the same hits, to check the tree and to measure its gain.
#include "trace/traverse_binary.clh"
#include "trace/query.clh"

static CLARAY_OUTLINED Hit test_all(global const BvhHeader* header, global const LeafTriangle* leaves CLARAY_CUTOUTS_PARAMETERS, Ray ray,
                                    uint mask, bool any) {
    if (!ray_valid(ray)) return no_hit(ray.tmax);
    PreparedRay prepared = prepare_ray(ray, CULL_BACK_FACES, mask);
    SET_CUTOUTS(&prepared, 0);
    Candidate best = no_candidate(ray.tmax);
    const uint valid = header->valid;
    for (uint i = 0; i < valid; ++i)
        if (try_leaf(&prepared, leaves, i, &best) && any) break;
    return finish_candidate(&prepared, leaves, best, ray.tmax, any);
}

kernel void brute_force_closest_hit(global const BvhHeader* header, global const LeafTriangle* leaves CLARAY_CUTOUTS_PARAMETERS,
                                    global const Ray* rays, global Hit* hits, uint capacity, global const uint* count,
                                    global const uint* masks) {
    const uint i = get_global_id(0);
    if (i >= rays_to_trace(capacity, count)) return;
    hits[i] = test_all(header, leaves CLARAY_CUTOUTS_ARGUMENTS, rays[i], mask_of_ray(masks, i), false);
}

kernel void brute_force_any_hit(global const BvhHeader* header, global const LeafTriangle* leaves CLARAY_CUTOUTS_PARAMETERS,
                                global const Ray* rays, global uchar* occluded, uint capacity, global const uint* count,
                                global const uint* masks) {
    const uint i = get_global_id(0);
    if (i >= rays_to_trace(capacity, count)) return;
    occluded[i] = test_all(header, leaves CLARAY_CUTOUTS_ARGUMENTS, rays[i], mask_of_ray(masks, i), true).primitive != CLARAY_MISS;
}
