// Samples of materials, and their evaluation of directions.
#include "verify/bsdf/bsdf.clh"

/// A sample, and if asked for eval_bsdf of its direction.
typedef struct Sampled { float x, y, z, weight, pdf, eval_value, eval_pdf; uint valid; } Sampled;

static CLARAY_OUTLINED Sampled draw(MATERIAL, float3 outgoing, uint i, uint seed, bool evaluates) {
    const BsdfView view = upright_view(tables, outgoing, inside);
    resolve_principled(&material, 0.0f);
    BsdfSample s;
    Sampled r = {0, 0, 0, 0, 0, 0, 0, 0};
    r.valid = sample_bsdf(&material, &view, three(i, seed), &s);
    if (r.valid) {
        r.x = s.incoming.x, r.y = s.incoming.y, r.z = s.incoming.z;
        r.weight = s.weight.x, r.pdf = s.pdf;
        if (evaluates) r.eval_value = eval_bsdf(&material, &view, s.incoming, &r.eval_pdf).x;
    }
    return r;
}

kernel void sample(MATERIAL, float ox, float oy, float oz, uint count, uint seed, uint evaluates, global Sampled* out) {
    const uint i = get_global_id(0);
    if (i < count) out[i] = draw(material, tables, inside, (float3)(ox, oy, oz), i, seed, evaluates != 0u);
}

static CLARAY_OUTLINED float evaluate(MATERIAL, float3 outgoing, float3 incoming, float* pdf) {
    resolve_principled(&material, 0.0f);
    const BsdfView view = upright_view(tables, outgoing, inside);
    return eval_bsdf(&material, &view, incoming, pdf).x / fabs(incoming.z);
}

kernel void eval(MATERIAL, float ox, float oy, float oz, uint count, global const float* directions,
                 global float* values, global float* pdfs) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    float pdf;
    values[i] = evaluate(material, tables, inside, (float3)(ox, oy, oz), vload3(i, directions), &pdf);
    pdfs[i] = pdf;
}

kernel void resolve(MATERIAL, uint count, global uint* kinds, global float* roughness) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    resolve_principled(&material, ((float)i + 0.5f) / (float)count);
    kinds[i] = material.kind, roughness[i] = material.roughness;
}
