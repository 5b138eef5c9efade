// render/generate_rays.cl as one would write it for a renderer that has pinholes alone: see bench/stripped.cpp.
#include "claray/shared/types.h"
#include "claray/shared/scene.h"
#include "render/samples.clh"
#include "math/vector.clh"

kernel void generate_rays(Batch batch, FrameData frame, uint centers, global Ray* rays, global float* radiance, global float* times) {
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    const uint pixel = pixel_of(batch, path);
    const float2 within = centers ? (float2)(0.5f) : draw(samples_of(batch, path, frame.seed), DIMENSION_FILM);
    const float x = 2.0f * ((float)(pixel % frame.width) + within.x) / (float)frame.width - 1.0f;
    const float y = 1.0f - 2.0f * ((float)(pixel / frame.width) + within.y) / (float)frame.height;
    const CameraData c = frame.camera;
    const float3 direction =
        normalize(fma(y, (float3)(c.up_x, c.up_y, c.up_z), fma(x, (float3)(c.right_x, c.right_y, c.right_z),
                                                               (float3)(c.forward_x, c.forward_y, c.forward_z))));
    const Ray ray = {c.x, c.y, c.z, 0.0f, direction.x, direction.y, direction.z, INFINITY};
    rays[path] = ray;
    vstore3((float3)(0.0f), path, radiance);
}
