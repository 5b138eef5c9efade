// Last pass of the denoiser: takes from the filtered light only as much as the noise warrants, and puts albedo and glow back.
#include "denoise/light.clh"

#ifndef BLEND_RADIUS
#define BLEND_RADIUS 3
#endif
#define BLEND_PIXELS ((2 * BLEND_RADIUS + 1) * (2 * BLEND_RADIUS + 1))

/// The variance that albedo and glow of few rays bring into filtered light; the pixel's own samples have none of it.
static inline float variance_of_guide(const Guide* g, float3 filtered) {
    const float bright = luminance(filtered), scale = luminance((float3)(g->albedo_r, g->albedo_g, g->albedo_b));
    return (g->albedo_variance * bright * bright + g->glow_variance) / (scale * scale);
}

/// Of all mixtures of a pixel and its filtered value, the one with the least squared error takes the share E[noise^2] /
/// E[(pixel - filtered)^2] of the latter (James and Stein 1961, "Estimation with quadratic loss"; expectations over the
/// neighbours), and less where the guide is noisier than the pixel. Where noise vanishes, so does the filter. `noisy` holds the
/// pixels and their variances, which count `doubt` times; 0: they are unknown, and all is taken from `filtered`.
kernel void modulate(FilterStep step, float doubt, global const float4* noisy, global const float4* filtered,
                     global const Guide* guides, global float* image) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    const bool lit = has_light(noisy[i]);
    float share = 1.0f;
    if (lit && doubt > 0.0f) {
        float noise = 0.0f, change = 0.0f, of_guides = 0.0f;
        for (int dy = -BLEND_RADIUS; dy <= BLEND_RADIUS; ++dy)
            for (int dx = -BLEND_RADIUS; dx <= BLEND_RADIUS; ++dx) {
                const uint at = neighbour(step, x + dx, y + dy);
                const float4 before = noisy[at];
                if (!has_light(before)) continue;
                const float3 after = filtered[at].xyz, difference = before.xyz - after;
                // Noise has the colour of light: else a change of colour alone would count as none.
                const float bright = luminance(after), colors = bright > 0.0f ? dot(after, after) / (bright * bright) : 3.0f;
                noise += before.w * colors, change += dot(difference, difference);
                if (abs(dx) > 1 || abs(dy) > 1) continue;
                const Guide g = guides[at];
                of_guides += variance_of_guide(&g, after) / 9.0f;
            }
        share = change > doubt * noise ? doubt * noise / change : 1.0f;
        const float own = fmax(noisy[i].w, 0.25f * noise / (float)BLEND_PIXELS) + 1e-30f;
        share *= own / (own + of_guides);
    }
    const Guide g = guides[i];
    const float3 light = mix(noisy[i].xyz, filtered[i].xyz, share);
    const float3 albedo = lit ? (float3)(g.albedo_r, g.albedo_g, g.albedo_b) : (float3)(1.0f);
    vstore3(light * albedo + (float3)(g.glow_r, g.glow_g, g.glow_b), i, image);
}
