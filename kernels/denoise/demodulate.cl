// First pass of the denoiser: the light of each pixel, the variance of its luminance, and its surface.
#include "claray/shared/path.h"
#include "denoise/light.clh"

/// The variance of the mean of all samples, from those of even and of odd index, as in measure_film.cl; 0 if either has none.
/// `glow_difference`: the part of their difference that is known.
static inline float variance_of(FilmPixel p, float glow_difference) {
    if (p.odd_count == 0u || p.odd_count == p.count) return 0.0f;
    const float3 sums = (float3)(p.all.r, p.all.g, p.all.b) + (float3)(p.all.lost_r, p.all.lost_g, p.all.lost_b);
    const float odd_sum = p.odd_sum + p.odd_error, even = (float)(p.count - p.odd_count), odd = (float)p.odd_count;
    const float difference = (luminance(sums) - odd_sum) / even - odd_sum / odd - glow_difference, all = even + odd;
    return difference * difference * (even / all) * (odd / all);
}

/// Of the film's samples, those of even index minus those of odd index: the part of their difference that guides know. 0: unknown.
static inline float glow_difference_of(FilmPixel p, const Guide* g) {
    const uint samples = p.count + p.dropped, odds = samples / 2u;
    if (!g->complete || odds == 0u) return 0.0f;
    const float all = (float)samples * luminance((float3)(g->sampled_glow_r, g->sampled_glow_g, g->sampled_glow_b));
    return (all - g->odd_glow) / (float)(samples - odds) - g->odd_glow / (float)odds;
}

/// `light`: radiance per albedo, and the variance of its luminance, from two samples on. `gloss`: the luminance of its part that
/// almost mirrors scatter, and its variance.
kernel void demodulate(FilterStep step, global const FilmPixel* film, global const Guide* guides, global float4* light,
                       global float4* surfaces, global float* weights, global float2* gloss) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const FilmPixel p = film[i];
    const Guide g = guides[i];
    const float3 sums = (float3)(p.all.r, p.all.g, p.all.b) + (float3)(p.all.lost_r, p.all.lost_g, p.all.lost_b);
    const float3 mean = p.count ? sums / (float)p.count : (float3)(0.0f);
    const float3 albedo = (float3)(g.sampled_albedo_r, g.sampled_albedo_g, g.sampled_albedo_b);
    const float3 reflected = mean - (float3)(g.sampled_glow_r, g.sampled_glow_g, g.sampled_glow_b);
    const float scale = luminance(albedo);
    const float3 glossy = (float3)(g.gloss_r, g.gloss_g, g.gloss_b);
    const float2 variances = (float2)(variance_of(p, glow_difference_of(p, &g)), g.complete ? g.gloss_variance : 0.0f) / (scale * scale);
    const bool lit = albedo.x > 0.0f;
    set_pixel(step, light, i, lit ? (float4)((reflected + glossy) / albedo, variances.x + variances.y) : (float4)(reflected + glossy, -1.0f));
    // Gloss of unknown variance is that of the film's own samples, and part of their variance.
    gloss[i] = lit && variances.y > 0.0f ? (float2)(luminance(glossy / albedo), variances.y) : (float2)(0.0f);
    weights[i] = scale;
    set_pixel(step, surfaces, i, (float4)(g.normal_x, g.normal_y, g.normal_z, g.nearness));
}
