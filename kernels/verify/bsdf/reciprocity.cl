// The reciprocity of materials.
#include "verify/bsdf/bsdf.clh"

/// Largest relative difference between the BSDF in both directions: n_o^2 f(o, i) = n_i^2 f(i, o). The sampler chooses every
/// other pair. `compared` receives the number of pairs.
static CLARAY_OUTLINED float worst_of_pairs(MATERIAL, uint item, uint pairs, uint* compared) {
    resolve_principled(&material, 0.0f);
    float most = 0.0f;
    uint some = 0u;
    for (uint k = 0; k < pairs; ++k) {
        const float3 a = three(item * pairs + k, 1u), b = three(item * pairs + k, 2u);
        const float z = 1.0f - a.x, around = b.z * 2.0f - 1.0f;
        const float3 o = (float3)(sqrt(1.0f - z * z) * cosine_and_sine(a.y), z);
        float3 i = (float3)(sqrt(1.0f - around * around) * cosine_and_sine(b.x), around);
        const BsdfView view = upright_view(tables, o, inside);
        BsdfSample s;
        if ((k & 1u) && sample_bsdf(&material, &view, (float3)(b.xy, a.z), &s)) i = s.incoming;
        if (i.z == 0.0f) continue;
        const bool through = i.z < 0.0f;
        // Seen from the other side the frame is turned around x.
        const float3 turn = through ? (float3)(1.0f, -1.0f, -1.0f) : (float3)(1.0f);
        float there = 0.0f, back = 0.0f;
#pragma unroll 1  // eval_bsdf is inlined, and NVIDIA's compiler takes half a minute for each copy
        for (uint way = 0; way < 2; ++way) {
            const BsdfView from = upright_view(tables, way ? i * turn : o, way ? inside != through : inside);
            float pdf;
            const float value = eval_bsdf(&material, &from, way ? o * turn : i, &pdf).x;
            if (way) back = value / o.z; else there = value / fabs(i.z);
        }
        if (through) {
            const float n2 = material.kind == CLARAY_THIN_WALLS ? 1.0f : material.ior * material.ior;
            if (inside) there *= n2; else back *= n2;
        }
        if (!(there > 1e-20f) && !(back > 1e-20f)) continue;
        most = fmax(most, fabs(there - back) / fmax(there, back));
        ++some;
    }
    *compared = some;
    return most;
}

kernel void reciprocity(MATERIAL, uint count, uint pairs, global float* worst, global uint* compared) {
    const uint item = get_global_id(0);
    if (item >= count) return;
    uint some;
    worst[item] = worst_of_pairs(material, tables, inside, item, pairs, &some);
    compared[item] = some;
}
