// Queries of arrays of rays against instances.
#include "trace/traverse_instances.clh"
#include "trace/query.clh"

#ifndef EVERY_INSTANCE
#define EVERY_INSTANCE 0  // 1: without the top level, to check it and to measure its gain
#endif

/// The time of ray i; 0 if `times` is absent.
static inline float time_of_ray(global const float* times, uint i) {
    return CLARAY_INSTANCE_MOTION && times ? times[i] : 0.0f;
}

static inline InstanceHit trace_every_instance(CLARAY_INSTANCES_PARAMETERS, Ray ray, float time, bool any, uint mask, Visits* visits) {
    InstanceHit best = no_instance_hit(ray.tmax);
    if (!ray_valid(ray)) return best;
    const uint valid = claray_top->valid;
    for (uint i = 0; i < valid; ++i)
        if (hit_instance(CLARAY_INSTANCES, claray_top_leaves[i].primitive, ray, time, any, CULL_BACK_FACES, mask, &best,
                         visits) && any)
            break;
    return best;
}

static CLARAY_OUTLINED InstanceHit trace_ray(CLARAY_INSTANCES_PARAMETERS, Ray ray, float time, bool any, uint mask, Visits* visits) {
    if (EVERY_INSTANCE) return trace_every_instance(CLARAY_INSTANCES, ray, time, any, mask, visits);
    return claray_trace_instances(CLARAY_INSTANCES, ray, time, any, CULL_BACK_FACES, mask, visits);
}

/// As the kernel closest_hit.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void closest_hit_instances(CLARAY_INSTANCES_PARAMETERS, global const Ray* rays, global InstanceHit* hits, uint capacity,
                           global const uint* count, global const uint* masks, global const float* times, global Visits* visits) {
    const uint all = rays_to_trace(capacity, count);
    FOR_EACH_RAY(i, all) {
        Visits visited = {0, 0};
        hits[i] = trace_ray(CLARAY_INSTANCES, rays[i], time_of_ray(times, i), false, mask_of_ray(masks, i), &visited);
        if (CLARAY_COUNT_VISITS) visits[i] = visited;
    }
}

/// As the kernel any_hit.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void any_hit_instances(CLARAY_INSTANCES_PARAMETERS, global const Ray* rays, global uchar* occluded, uint capacity,
                       global const uint* count, global const uint* masks, global const float* times) {
    const uint all = rays_to_trace(capacity, count);
    Visits unused = {0, 0};
    FOR_EACH_RAY(i, all)
        occluded[i] = trace_ray(CLARAY_INSTANCES, rays[i], time_of_ray(times, i), true, mask_of_ray(masks, i), &unused).primitive != CLARAY_MISS;
}
