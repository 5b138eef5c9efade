// First stage: generates a camera ray and the state of each path of a batch. Later stages know pixels and samples from there.
#include "claray/shared/types.h"
#include "render/first_ray.clh"
#include "render/queue.clh"

#if CLARAY_CPU
/// Sixteen paths per work-item. Their radiance is cleared. `centers`: rays go through the centres of pixels and lens at shutter open. `times`
/// is written under INSTANCE_MOTION only.
kernel void generate_rays(Batch batch, FrameData of_frame, uint centers, global const uint* tables, global Ray* rays, global PathState* states,
                          global float* radiance, global float* times) {
    const FrameData* frame = &of_frame;
    const uint all = batch.pixels * batch.samples, begin = 16u * (uint)get_global_id(0);
    if (begin >= all) return;
    const uint count = min(16u, all - begin);
    const uint16 lanes = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const uint16 paths = begin + lanes, of_batch = quotients16(paths, batch.samples);
    const uint16 pixels = pixels_of_16(batch, TABLE(uint, listed_pixels), of_batch);
    const uint16 seeds = hash_words16(pixels, (uint16)(frame->seed));
    const uint16 numbers = first_samples_of_16(batch, TABLE(uint, listed_pixels), of_batch) + (paths - of_batch * batch.samples);
    store_first_rays16(frame, pixels, seeds, numbers, centers, count, rays + begin, times + begin);
    float4 names[16];
    rows_of_columns16(as_float16(paths), as_float16(pixels), as_float16(numbers), (float16)(0.0f), names);
    for (uint i = 0; i < count; ++i) {
        vstore4((float4)(1.0f, 1.0f, 1.0f, 0.0f), 0, (global float*)&states[begin + i]);
        vstore4(names[PLACE_OF_ROW(i)], 1, (global float*)&states[begin + i]);
        vstore3((float3)(0.0f), begin + i, radiance);
    }
}
#else
static inline Ray center_ray(const FrameData* frame, uint pixel) { return ray_through(frame, pixel, (float2)(0.5f), (float2)(0.5f), 0.0f); }

/// One path per work-item; as above.
kernel void generate_rays(Batch batch, FrameData of_frame, uint centers, global const uint* tables, global Ray* rays, global PathState* states,
                          global float* radiance, global float* times) {
    const FrameData* frame = &of_frame;
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    float time = 0.0f;
    const PathState state = first_state(batch, TABLE(uint, listed_pixels), path);
    store_ray(&rays[path], centers ? center_ray(frame, state.pixel) : first_ray(frame, state, &time));
    store_state(&states[path], state);
    vstore3((float3)(0.0f), path, radiance);
    if (INSTANCE_MOTION) times[path] = time;
}
#endif
