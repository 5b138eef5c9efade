// First stage of baking: paths begin at points of surfaces instead of at the camera.
#include "claray/shared/types.h"
#include "render/queue.clh"
#include "render/samples.clh"
#include "shade/surface.clh"

/// Point p of a batch is a hit with given u, v and primitive, seen from the front along the normal. Clears the radiance of the
/// paths.
kernel void generate_texels(Batch batch, global const Hit* points, global const float* positions,
                            global const uint* indices, global Ray* rays, global PathState* states, global Hit* hits, global float* radiance) {
    const uint path = get_global_id(0);
    if (path >= batch.pixels * batch.samples) return;
    const PathState state = first_state(batch, 0, path);
    const Hit hit = points[state.pixel];
    const uint first = 3 * hit.primitive;
    const float3 base = load3(positions, indices[first]);
    const float3 e1 = load3(positions, indices[first + 1]) - base, e2 = load3(positions, indices[first + 2]) - base;
    const float3 normal = triangle_normal(e1, e2), from = base + hit.u * e1 + hit.v * e2 + normal;
    const Ray ray = {from.x, from.y, from.z, 0.0f, -normal.x, -normal.y, -normal.z, INFINITY};
    rays[path] = ray;
    store_state(&states[path], state);
    hits[path] = hit;
    vstore3((float3)(0.0f), path, radiance);
}
