// Follows the last paths of a batch to their ends. Few paths are left after some surfaces, and launching the stages again for each
// further surface would take longer than tracing them.
#include "render/follow_path.clh"
#include "render/queues/segments.clh"

/// For the rays of `queue`, at `step.depth`, which the next stages would trace; `end`: largest number of rays of a path, with that of
/// the camera. Counts the further rays in the lengths of the queues that would be filled next, which are 0 before.
kernel QUERY_GROUP
void finish_paths(Step step, CLARAY_BVH_PARAMETERS, SCENE_PARAMETERS, global RayQueue* queue, global float* radiance,
                  global QueueLength* lengths, uint end) {
    local uint counts[2];
    PathRays rays = {0, 0};
    const uint i = get_global_id(0);
    if (i < min(*length_of_rays(lengths, step.depth), step.capacity)) {
        NextRay next;
        next.wanted = true;
        next.segment = queued_segment(&step.frame, step.depth, queue, step.room, i);
        next.state = queued_state(&states_of_queue(queue, step.room)[i]);
        const uint path = next.state.path;
        vstore3(follow_path(&step, step.depth, end, CLARAY_BVH, SCENE, next, vload3(path, radiance),
                            radiance + 3 * (size_t)step.room, &rays),
                path, radiance);
    }
    count_rays(rays, counts, length_of_rays(lengths, step.depth + 1), length_of_shadows(lengths, step.depth));
}
