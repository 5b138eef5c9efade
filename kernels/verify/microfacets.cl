// Single functions of microfacets: Fresnel's equations and GGX.
#include "claray/shared/rng.h"
#include "bsdf/ggx.clh"
#include "bsdf/fresnel.clh"

kernel void fresnel(uint count, global const float* cosines, global const float* etas, global float* out) {
    const uint i = get_global_id(0);
    float beyond;
    if (i < count) out[i] = fresnel_dielectric(cosines[i], etas[i], &beyond);
}

kernel void density(uint count, global const float* angles, global const float* alphas, global float* out) {
    const uint i = get_global_id(0);
    if (i < count) out[i] = ggx_d((float3)(sin(angles[i]), 0.0f, cos(angles[i])), alphas[i]);
}

/// Albedo of GGX's single scattering with a Fresnel term of 1: eval_ggx over the density of the sampler.
kernel void single_scattering(uint count, uint samples, global const float* cosines, global const float* alphas, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 outgoing = (float3)(sqrt(1.0f - cosines[i] * cosines[i]), 0.0f, cosines[i]);
    float sum = 0.0f;
    for (uint first = 0; first < samples; first += 256) {
        float part = 0.0f;
        for (uint k = first; k < min(first + 256, samples); ++k) {
            const SamplePair a = sobol_pair(k, 7u);
            const float3 incoming = scatter_ggx(outgoing, alphas[i], (float2)(unit_float(a.x), unit_float(a.y)));
            if (!(incoming.z > 0.0f)) continue;
            float cosine, pdf;
            const float value = eval_ggx(outgoing, incoming, alphas[i], &cosine, &pdf);
            if (pdf > 0.0f) part += value / pdf;
        }
        sum += part;
    }
    out[i] = sum / (float)samples;
}
