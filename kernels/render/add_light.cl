// The stage after the shadow rays, if their query does not add the light itself (see trace_shadow_rays.cl): adds the light of
// shadow rays that hit nothing to their paths.
#include "render/queue.clh"

kernel void add_light(global const uint* length, uint capacity, global const uchar* occluded,
                      global const LightSample* light, global float* radiance) {
    const uint i = get_global_id(0);
    if (i < min(*length, capacity) && !occluded[i]) add_light_sample(queued_light(&light[i]), radiance);
}
