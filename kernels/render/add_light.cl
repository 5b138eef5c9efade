// The stage after the shadow rays, where the query does not add the light itself (see trace_shadow_rays.cl): light that nothing was in
// the way of reaches its path.
#include "render/queue.clh"

kernel void add_light(global const uint* length, uint capacity, global const uchar* occluded,
                      global const LightSample* light, global float* radiance) {
    const uint i = get_global_id(0);
    if (i < min(*length, capacity) && !occluded[i]) add_light_sample(queued_light(&light[i]), radiance);
}
