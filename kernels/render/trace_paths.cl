// The path tracer in one kernel: a work-item follows its path from the camera to the end. This is faster if paths do similar work:
// in scenes with few effects that paths leave soon (Laine, Karras and Aila 2013, "Megakernels considered harmful", explain why
// not in others).
/// The state at the camera of this work-item's path.
#define FIRST_STATE first_state(step->batch, TABLE(uint, listed_pixels), get_global_id(0))
#include "render/follow_path.clh"

/// Traces all paths of a batch, with at most `step.depth` rays each, and writes their radiance.
/// Counts the rays in the lengths of the queues, which are 0 before. `radiance`: see shade_surface.
kernel QUERY_GROUP
void trace_paths(Step step, CLARAY_BVH_PARAMETERS, SCENE_PARAMETERS, global float* radiance, global QueueLength* lengths) {
    local uint counts[2];
    PathRays rays = {0, 0};
    const uint path = get_global_id(0);
    if (path < step.batch.pixels * step.batch.samples) {
        float time = 0.0f;
        NextRay next;
        next.wanted = true;
        const FrameData* frame = &step.frame;
        next.state = first_state(step.batch, TABLE(uint, listed_pixels), path);
        next.segment = camera_segment(frame, first_ray(frame, next.state, &time), time);
        vstore3(follow_path(&step, 0, step.depth, CLARAY_BVH, SCENE, next, (float3)(0.0f),
                            radiance + 3 * (size_t)step.room, &rays),
                path, radiance);
    }
    count_rays(rays, counts, length_of_rays(lengths, 1), length_of_shadows(lengths, 0));
}
