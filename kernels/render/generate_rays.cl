// First stage: a camera ray for every path of a batch.
#include "claray/shared/types.h"
#include "render/samples.clh"
#include "shade/camera.clh"

#ifndef INSTANCE_MOTION
#define INSTANCE_MOTION 0  // 1: every ray has a time, at which the instances are where it meets them
#endif

/// Rays through random points of the pixels (box filter), of the lens and of the time that the shutter is open, or through the
/// pixels' and the lens' centres as it opens. Clears the paths' radiance. `times` is written under INSTANCE_MOTION only.
kernel void generate_rays(Batch batch, FrameData frame, uint centers, global Ray* rays, global PathState* states,
                          global float* radiance, global float* times) {
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    const uint pixel = pixel_of(batch, path);
    const PathSamples samples = samples_of(batch, path, frame.seed);
    const float2 within = centers ? (float2)(0.5f) : draw(samples, DIMENSION_FILM);
    const float x = 2.0f * ((float)(pixel % frame.width) + within.x) / (float)frame.width - 1.0f;
    const float y = 1.0f - 2.0f * ((float)(pixel / frame.width) + within.y) / (float)frame.height;
    CameraData camera = frame.camera;
    float2 lens = (float2)(0.5f);
#if DEPTH_OF_FIELD
    if (!centers) lens = draw(samples, DIMENSION_LENS);
#endif
#if CAMERA_MOTION || INSTANCE_MOTION
    const float time = centers ? 0.0f : time_of(samples);
#endif
#if CAMERA_MOTION
    if (camera_moves(&camera)) camera = move_camera(camera, time);
#endif
#if INSTANCE_MOTION
    times[path] = time;
#endif
    const PathState state = {1.0f, 1.0f, 1.0f, 0.0f, path};
    rays[path] = camera_ray(camera, x, y, lens);
    states[path] = state;
    vstore3((float3)(0.0f), path, radiance);
}
