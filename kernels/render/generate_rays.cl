// First stage: generates a camera ray for each path of a batch.
#include "claray/shared/types.h"
#include "render/first_ray.clh"
#include "render/queue.clh"

/// `centers`: rays go through pixel centres, see first_ray. Clears the radiance of the paths. `times` is written under
/// INSTANCE_MOTION only.
kernel void generate_rays(Batch batch, FrameData frame, uint centers, global Ray* rays, global float* radiance, global float* times) {
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    float time = 0.0f;
    store_ray(&rays[path], first_ray(batch, frame, path, centers != 0, &time));
    vstore3((float3)(0.0f), path, radiance);
#if INSTANCE_MOTION
    times[path] = time;
#endif
}
