// The albedo of materials.
#include "verify/bsdf/bsdf.clh"

static inline float radical_inverse(uint k, uint base) {
    float inverse = 0.0f, digit = 1.0f;
    for (; k > 0u; k /= base) {
        digit /= (float)base;
        inverse += digit * (float)(k % base);
    }
    return fmin(inverse, 1.0f - 0x1p-24f);
}

/// Directional albedos at the cosines, by Hammersley's points in four dimensions (1960, "Monte Carlo methods for solving
/// multivariable problems").
kernel void albedo(MATERIAL, uint count, uint samples, global const float* cosines, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const BsdfView view = upright_view(tables, (float3)(sqrt(1.0f - cosines[i] * cosines[i]), 0.0f, cosines[i]), inside);
    float sum = 0.0f;
    for (uint k = 0; k < samples; ++k) {
        const float4 at = {((float)k + 0.5f) / (float)samples, radical_inverse(k, 2u), radical_inverse(k, 3u), radical_inverse(k, 5u)};
        MaterialData one = material;
        resolve_principled(&one, at.w);
        BsdfSample s;
        if (sample_bsdf(&one, &view, at.xyz, &s))
            sum += s.weight.x;
    }
    out[i] = sum / (float)samples;
}
