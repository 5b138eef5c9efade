// The stage after the shadow rays: light that nothing was in the way of reaches its path. Every path has at most one shadow
// ray at a time, so no two work-items add to the same one.
#include "claray/shared/path.h"

kernel void add_light(global const uint* length, uint capacity, global const uchar* occluded,
                      global const LightSample* light, global float* radiance) {
    const uint i = get_global_id(0);
    if (i >= min(*length, capacity) || occluded[i]) return;
    const LightSample sample = light[i];
    vstore3(vload3(sample.path, radiance) + (float3)(sample.r, sample.g, sample.b), sample.path, radiance);
}
