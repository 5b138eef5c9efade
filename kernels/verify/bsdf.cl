// Materials one at a time: what they sample, what they say of directions, and how much light they scatter. Every kernel has the
// parameters MATERIAL, but for those of single functions at the end.
#include "claray/shared/rng.h"
#include "shade/bsdf.clh"
/// A sample, and what eval_bsdf says of it.
typedef struct Sampled { float x, y, z, weight, pdf, eval_value, eval_pdf; uint valid; } Sampled;
#define MATERIAL MaterialData material, global const float* tables, uint inside

static float3 three(uint i, uint seed) {
    const SamplePair a = sample_pair(CLARAY_INDEPENDENT, seed, i, 0u), b = sample_pair(CLARAY_INDEPENDENT, seed, i, 1u);
    return (float3)(unit_float(a.x), unit_float(a.y), unit_float(b.x));
}
kernel void sample(MATERIAL, float ox, float oy, float oz, uint count, global Sampled* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 outgoing = (float3)(ox, oy, oz);
    BsdfSample s;
    Sampled r = {0, 0, 0, 0, 0, 0, 0, 0};
    r.valid = sample_bsdf(&material, tables, outgoing, inside, three(i, 4321u), &s);
    if (r.valid) {
        r.x = s.incoming.x, r.y = s.incoming.y, r.z = s.incoming.z;
        r.weight = s.weight.x, r.pdf = s.pdf;
        r.eval_value = eval_bsdf(&material, tables, outgoing, s.incoming, inside, &r.eval_pdf).x;
    }
    out[i] = r;
}
kernel void eval(MATERIAL, float ox, float oy, float oz, uint count, global const float* directions,
                 global float* values, global float* pdfs) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 incoming = vload3(i, directions);
    float pdf;
    values[i] = eval_bsdf(&material, tables, (float3)(ox, oy, oz), incoming, inside, &pdf).x / fabs(incoming.z);
    pdfs[i] = pdf;
}
/// Directional albedos at the cosines, by Sobol samples of the sampler.
kernel void albedo(MATERIAL, uint count, uint samples, global const float* cosines, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 outgoing = (float3)(sqrt(1.0f - cosines[i] * cosines[i]), 0.0f, cosines[i]);
    float sum = 0.0f;
    for (uint k = 0; k < samples; ++k) {
        const SamplePair a = sobol_pair(k, 7u), b = sobol_pair(k, 77u);
        MaterialData one = material;
        resolve_principled(&one, unit_float(b.y));
        BsdfSample s;
        if (sample_bsdf(&one, tables, outgoing, inside,
                        (float3)(unit_float(a.x), unit_float(a.y), unit_float(b.x)), &s))
            sum += s.weight.x;
    }
    out[i] = sum / (float)samples;
}
/// Largest relative difference between the BSDF one way and back: n_o^2 f(o, i) = n_i^2 f(i, o). Every other pair is
/// one that the sampler chooses.
kernel void reciprocity(MATERIAL, uint count, uint pairs, global float* worst, global uint* compared) {
    const uint item = get_global_id(0);
    if (item >= count) return;
    float most = 0.0f;
    uint some = 0u;
    for (uint k = 0; k < pairs; ++k) {
        const float3 a = three(item * pairs + k, 1u), b = three(item * pairs + k, 2u);
        const float z = 1.0f - a.x, around = b.z * 2.0f - 1.0f;
        const float3 o = (float3)(sqrt(1.0f - z * z) * cosine_and_sine(a.y), z);
        float3 i = (float3)(sqrt(1.0f - around * around) * cosine_and_sine(b.x), around);
        BsdfSample s;
        if ((k & 1u) && sample_bsdf(&material, tables, o, inside, (float3)(b.xy, a.z), &s)) i = s.incoming;
        if (i.z == 0.0f) continue;
        const bool through = i.z < 0.0f;
        float pdf;
        float there = eval_bsdf(&material, tables, o, i, inside, &pdf).x / fabs(i.z);
        // Seen from the other side the frame is turned around x.
        const float3 turn = through ? (float3)(1.0f, -1.0f, -1.0f) : (float3)(1.0f);
        float back = eval_bsdf(&material, tables, i * turn, o * turn, inside != through, &pdf).x / o.z;
        if (through) {
            const float n2 = material.kind == CLARAY_THIN_GLASS ? 1.0f : material.ior * material.ior;
            if (inside) there *= n2; else back *= n2;
        }
        if (!(there > 1e-20f) && !(back > 1e-20f)) continue;
        most = fmax(most, fabs(there - back) / fmax(there, back));
        ++some;
    }
    worst[item] = most;
    compared[item] = some;
}
kernel void resolve(MATERIAL, uint count, global uint* kinds, global float* roughness) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    resolve_principled(&material, ((float)i + 0.5f) / (float)count);
    kinds[i] = material.kind, roughness[i] = material.roughness;
}
kernel void fresnel(uint count, global const float* cosines, global const float* etas, global float* out) {
    const uint i = get_global_id(0);
    float beyond;
    if (i < count) out[i] = fresnel_dielectric(cosines[i], etas[i], &beyond);
}
kernel void density(uint count, global const float* angles, global const float* alphas, global float* out) {
    const uint i = get_global_id(0);
    if (i < count) out[i] = ggx_d((float3)(sin(angles[i]), 0.0f, cos(angles[i])), alphas[i]);
}
/// Share of light that GGX scatters once, Fresnel's term being 1: eval_ggx over the density of the sampler.
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
