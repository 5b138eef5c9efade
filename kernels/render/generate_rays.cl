// First stage: generates a camera ray for each path of a batch.
#include "claray/shared/types.h"
#include "render/first_ray.clh"
#include "render/queue.clh"

#if CLARAY_CPU
/// Sixteen paths per work-item. Their radiance is cleared. `centers`: rays go through the centres of pixels and lens at shutter open. `times`
/// is written under INSTANCE_MOTION only.
kernel void generate_rays(Batch batch, FrameData of_frame, uint centers, global const uint* tables, global Ray* rays, global float* radiance,
                          global float* times) {
    const FrameData* frame = &of_frame;
    const uint all = batch.pixels * batch.samples, begin = 16u * (uint)get_global_id(0);
    if (begin >= all) return;
    const uint count = min(16u, all - begin);
    const uint16 lanes = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const uint16 paths = begin + lanes, of_batch = quotients16(paths, batch.samples);
    const uint16 pixels = pixels_of_16(batch, TABLE(uint, listed_pixels), of_batch);
    const uint16 seeds = hash_words_of_16(pixels, (uint16)(frame->seed));
    const uint16 numbers = first_samples_of_16(batch, TABLE(uint, listed_pixels), of_batch) + (paths - of_batch * batch.samples);
    store_first_rays16(frame, pixels, seeds, numbers, centers, count, rays + begin, times + begin);
    for (uint i = 0; i < count; ++i) vstore3((float3)(0.0f), begin + i, radiance);
}
#else
static inline Ray center_ray(Batch batch, const FrameData* frame, global const uint* tables, uint path) {
    return ray_through(frame, pixel_of(batch, TABLE(uint, listed_pixels), path), (float2)(0.5f), (float2)(0.5f), 0.0f);
}

/// One path per work-item; as above.
kernel void generate_rays(Batch batch, FrameData of_frame, uint centers, global const uint* tables, global Ray* rays, global float* radiance,
                          global float* times) {
    const FrameData* frame = &of_frame;
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    float time = 0.0f;
    const Ray ray = centers ? center_ray(batch, frame, tables, path) : first_ray(batch, frame, tables, path, &time);
    store_ray(&rays[path], ray);
    vstore3((float3)(0.0f), path, radiance);
#if INSTANCE_MOTION
    times[path] = time;
#endif
}
#endif
