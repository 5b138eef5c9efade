// Last pass of the denoiser: takes from the filtered light only as much as the noise warrants, and puts albedo and glow back.
#include "denoise/light.clh"

#ifndef BLEND_RADIUS
#define BLEND_RADIUS 3
#endif

#define DOUBT 2.0f  // variances from two halves of a few samples are too small more often than too large

/// Of all mixtures of a pixel and its filtered value, the one with the least squared error takes the share E[noise^2] /
/// E[(pixel - filtered)^2] of the latter (James and Stein 1961, "Estimation with quadratic loss"; expectations over the
/// neighbours). Where noise vanishes, so does the filter. `noisy` holds the pixels and their variances. `blends`: 0: all of the
/// latter.
kernel void modulate(FilterStep step, uint blends, global const float4* noisy, global const float4* filtered,
                     global const Guide* guides, global float* image) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    float share = 1.0f;
    if (blends) {
        float noise = 0.0f, change = 0.0f;
        for (int dy = -BLEND_RADIUS; dy <= BLEND_RADIUS; ++dy)
            for (int dx = -BLEND_RADIUS; dx <= BLEND_RADIUS; ++dx) {
                const uint at = neighbour(step, x + dx, y + dy);
                const float4 before = noisy[at];
                if (!has_light(before)) continue;
                const float difference = luminance(before.xyz) - luminance(filtered[at].xyz);
                noise += before.w, change += difference * difference;
            }
        share = change > DOUBT * noise ? DOUBT * noise / change : 1.0f;
    }
    const Guide g = guides[i];
    const float3 light = mix(noisy[i].xyz, filtered[i].xyz, share);
    const float3 albedo = (float3)(g.albedo_r, g.albedo_g, g.albedo_b);
    vstore3(light * albedo + (float3)(g.glow_r, g.glow_g, g.glow_b), i, image);
}
