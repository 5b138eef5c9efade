// The stage add_light of renders with layers of light: also adds the light of shadow rays that hit nothing to its layers.
#include "render/layers/layer_sums.clh"
#include "render/queue.clh"

/// `radiance`: of `room` paths, with their layers.
kernel void add_light_layers(global const uint* length, uint capacity, global const uchar* occluded, global const LightSample* light,
                             global float* radiance, uint room) {
    const uint i = get_global_id(0);
    if (i >= min(*length, capacity) || occluded[i]) return;
    const LightSample sample = queued_light(&light[i]);
    add_light_sample(sample, radiance);
    const Layers layers = layers_behind(radiance, room);
    const LobeSample lobe = *lobe_sample(&layers, sample.path);
    const FirstLobe first = {lobe.diffuse_r, lobe.diffuse_g, lobe.diffuse_b, lobe.transmits};
    const float3 color = (float3)(sample.r, sample.g, sample.b);
    add_by_first(&layers, first, lobe.indirect != 0u, sample.path, color);
    add_to_group(&layers, lobe.group, sample.path, color);
}
