// The path tracer in one kernel: a work-item follows its path from the camera to the end. It keeps in registers the values that
// the wavefront's stages pass through memory. This is faster if paths do similar work: in scenes with few effects that paths
// leave soon (Laine, Karras and Aila 2013, "Megakernels considered harmful", explain why not in others).

// Scenes with instances are rendered by the stages.
#undef INSTANCES
#undef INSTANCE_MOTION
#define INSTANCES 0
#define INSTANCE_MOTION 0

#include "claray/shared/types.h"
#include "render/first_ray.clh"
#include "render/queue.clh"
#include "render/shade_hit.clh"
#include "trace/closest_hit.clh"
#include "trace/query.clh"

/// Traces all paths of a batch, with at most `step.depth` rays each, and writes their radiance, added in the order of the stages.
/// Counts the rays in the lengths of the queues, which are 0 before. `radiance`: see shade_surface.
kernel QUERY_GROUP
void trace_paths(Step step, CLARAY_BVH_PARAMETERS, SCENE_PARAMETERS, global float* radiance, global QueueLength* lengths) {
    const Batch batch = step.batch;
    global float* shading_normals = radiance + 3 * (size_t)step.room;
    local uint counts[2];
    if (get_local_id(0) == 0) counts[0] = counts[1] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint path = get_global_id(0);
    if (path < batch.pixels * batch.samples) {
        uint bounced = 0, asked = 0;
        float3 sum = (float3)(0.0f);
        float time = 0.0f;
        NextRay next;
        next.wanted = true;
        next.ray = first_ray(batch, step.frame, path, false, &time);
        next.state = first_state(path);
        next.cone = camera_cone(&step.frame);
        for (uint depth = 0; next.wanted && depth < step.depth; ++depth) {
            const NextRay now = next;
            Visits unused = {0, 0};
            const Hit hit = claray_trace(CLARAY_BVH, now.ray, false, CULL_BACK_FACES, 0xffffffffu, &unused);
            NextShadow shadow;
            float3 gathered;
            shade_hit(&step, depth, SCENE, now.ray, hit, time, now.state, now.cone, shading_normals, &gathered, &next, &shadow);
            sum += gathered;
            bounced += next.wanted;
#if LIGHTS
            if (!shadow.wanted) continue;
            ++asked;
            if (claray_trace(CLARAY_BVH, shadow.ray, true, CULL_BACK_FACES, 0xffffffffu, &unused).primitive == CLARAY_MISS)
                sum += (float3)(shadow.light.r, shadow.light.g, shadow.light.b);
#endif
        }
        vstore3(sum, path, radiance);
        atomic_add(&counts[0], bounced);
        atomic_add(&counts[1], asked);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) {
        atomic_add(length_of_rays(lengths, 1), counts[0]);
        atomic_add(length_of_shadows(lengths, 0), counts[1]);
    }
}
