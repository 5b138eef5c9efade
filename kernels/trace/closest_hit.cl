// Closest-hit query of an array of rays.
#include "trace/queue/ray_queue.clh"

/// Traces the first min(capacity, *count) rays, or all if `count` is absent. `masks` is read under CLARAY_RAY_MASKS, `visits`
/// written under CLARAY_COUNT_VISITS. `queue`: see ray_queue.clh. `batch` is the number of rays per item and `sorted` their order
/// or null: see batch.clh.
kernel QUERY_GROUP
void closest_hit(CLARAY_BVH_PARAMETERS, global const Ray* rays, global Hit* hits, uint capacity,
                 global const uint* count, global const uint* masks, global Visits* visits, volatile global uint* queue,
                 uint batch, global const uint* sorted) {
    const uint all = rays_to_trace(capacity, count);
#if USE_RAY_QUEUE
    const Query query = {rays, masks, all, false, hits, NO_ANSWERS};
    trace_queue(CLARAY_BVH, &query, queue);
#elif USE_BATCHES
    const BatchQuery query = {rays, masks, sorted, false, CULL_BACK_FACES, hits, 0};
    trace_batches(CLARAY_BVH, &query, queue, (uint)get_global_size(0), batch, all);
#elif !CHOOSE || COHERENT  // else the other schedule's kernel traces them
    FOR_EACH_RAY(i, all) {
        Visits visited = {0, 0};
        hits[i] = claray_trace(CLARAY_BVH, rays[i], false, CULL_BACK_FACES, mask_of_ray(masks, i), &visited);
        if (CLARAY_COUNT_VISITS) visits[i] = visited;
    }
#endif
}
