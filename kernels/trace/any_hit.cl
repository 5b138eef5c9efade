// Any-hit query of an array of rays.
#include "trace/queue/ray_queue.clh"

static CLARAY_OUTLINED bool is_occluded(CLARAY_BVH_PARAMETERS, Ray ray, uint mask, Visits* visited) {
    return claray_trace(CLARAY_BVH, ray, true, CULL_BACK_FACES, mask, visited).primitive != CLARAY_MISS;
}

/// As the kernel closest_hit; answers.clh stores the answers.
kernel QUERY_GROUP
void any_hit(CLARAY_BVH_PARAMETERS, global const Ray* rays, ANSWERS_PARAMETERS, uint capacity,
             global const uint* count, global const uint* masks, global Visits* visits, volatile global uint* queue,
             uint batch, global const uint* sorted) {
    const uint all = rays_to_trace(capacity, count);
#if USE_RAY_QUEUE
    const Query query = {rays, masks, all, true, 0, ANSWERS};
    trace_queue(CLARAY_BVH, &query, queue);
#elif USE_BATCHES
    const BatchQuery query = {rays, masks, sorted, true, CULL_BACK_FACES, 0, occluded};
    trace_batches(CLARAY_BVH, &query, queue, (uint)get_global_size(0), batch, all);
#else
    FOR_EACH_RAY(i, all) {
        Visits visited = {0, 0};
        const Answers answers = ANSWERS;
        answer(&answers, i, is_occluded(CLARAY_BVH, rays[i], mask_of_ray(masks, i), &visited));
        if (CLARAY_COUNT_VISITS) visits[i] = visited;
    }
#endif
}
