// First stage: generates a camera ray for each path of a batch.
#include "claray/shared/types.h"
#include "render/first_ray.clh"
#include "render/queue.clh"
#if CLARAY_CPU
#include "math/vector_sixteen.clh"
#endif

/// Stores a ray and clears the radiance of its path. `times` is written under INSTANCE_MOTION only.
static inline void start_path(uint path, Ray ray, float time, global Ray* rays, global float* radiance, global float* times) {
    store_ray(&rays[path], ray);
    vstore3((float3)(0.0f), path, radiance);
#if INSTANCE_MOTION
    times[path] = time;
#endif
}

static inline Ray center_ray(Batch batch, const FrameData* frame, global const uint* tables, uint path) {
    return ray_through(frame, pixel_of(batch, TABLE(uint, listed_pixels), path), (float2)(0.5f), (float2)(0.5f), 0.0f);
}

#if CLARAY_CPU
/// Sixteen paths per work-item: the points in their pixels are drawn in the lanes of vectors, with the bits of first_ray. `centers`: rays
/// go through the centres of pixels and lens at shutter open.
kernel void generate_rays(Batch batch, FrameData of_frame, uint centers, global const uint* tables, global Ray* rays, global float* radiance,
                          global float* times) {
    const FrameData* frame = &of_frame;
    const uint all = batch.pixels * batch.samples, begin = 16u * (uint)get_global_id(0);
    if (begin >= all) return;
    const uint16 lanes = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const uint16 paths = begin + lanes, of_batch = paths / batch.samples;
    const uint16 pixels = pixels_of_16(batch, TABLE(uint, listed_pixels), of_batch);
    const uint16 seeds = hash_words_of_16(pixels, (uint16)(frame->seed));
    const uint16 numbers = first_samples_of_16(batch, TABLE(uint, listed_pixels), of_batch) + (paths - of_batch * batch.samples);
    const SamplePairs16 drawn = sample_pair_of_16(SAMPLER, seeds, numbers, (uint16)(DIMENSION_FILM));
    uint pixel[16], seed[16], number[16];
    float x[16], y[16];
    vstore16(pixels, 0, pixel), vstore16(seeds, 0, seed), vstore16(numbers, 0, number);
    vstore16(unit_floats16(drawn.x), 0, x), vstore16(unit_floats16(drawn.y), 0, y);
    for (uint i = 0; i < min(16u, all - begin); ++i) {
        const PathSamples samples = {seed[i], number[i]};
        float time = 0.0f;
        const Ray ray = centers ? center_ray(batch, frame, tables, begin + i)
                                : ray_at_random_time(frame, pixel[i], (float2)(x[i], y[i]), samples, &time);
        start_path(begin + i, ray, time, rays, radiance, times);
    }
}
#else
/// One path per work-item. `centers`: as above.
kernel void generate_rays(Batch batch, FrameData of_frame, uint centers, global const uint* tables, global Ray* rays, global float* radiance,
                          global float* times) {
    const FrameData* frame = &of_frame;
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    float time = 0.0f;
    const Ray ray = centers ? center_ray(batch, frame, tables, path) : first_ray(batch, frame, tables, path, &time);
    start_path(path, ray, time, rays, radiance, times);
}
#endif
