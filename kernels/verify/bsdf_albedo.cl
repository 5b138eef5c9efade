// The albedo of materials.
#include "verify/bsdf.clh"

/// Directional albedos at the cosines, by Sobol samples of the sampler.
kernel void albedo(MATERIAL, uint count, uint samples, global const float* cosines, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const BsdfView view = {tables, (float3)(sqrt(1.0f - cosines[i] * cosines[i]), 0.0f, cosines[i]), UP, inside};
    float sum = 0.0f;
    for (uint k = 0; k < samples; ++k) {
        const SamplePair a = sobol_pair(k, 7u), b = sobol_pair(k, 77u);
        MaterialData one = material;
        resolve_principled(&one, unit_float(b.y));
        BsdfSample s;
        if (sample_bsdf(&one, &view, (float3)(unit_float(a.x), unit_float(a.y), unit_float(b.x)), &s))
            sum += s.weight.x;
    }
    out[i] = sum / (float)samples;
}
