// Vertex normals that disagree with their triangle, up to those in its plane: the normals that shading uses instead.
#include "claray/shared/rng.h"
#include "math/normals.clh"
#include "math/vector.clh"

/// Three numbers each: cosine to the viewer, height of the mirrored view over the surface, length.
kernel void shading_normals(uint count, uint seed, global float* cosines) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const SamplePair a = independent_pair(i, hash_word(seed)), b = independent_pair(i, hash_word(seed + 1u));
    const float3 geometric = (float3)(0.0f, 1.0f, 0.0f);
    const float2 n = cosine_and_sine(unit_float(a.x)), o = cosine_and_sine(unit_float(b.x));
    const float up = unit_float(a.y), height = 0.001f + 0.999f * unit_float(b.y) * unit_float(b.y);
    const float3 shading = (float3)(sqrt(1.0f - up * up) * n.x, up, sqrt(1.0f - up * up) * n.y);
    const float3 outgoing = (float3)(sqrt(1.0f - height * height) * o.x, height, sqrt(1.0f - height * height) * o.y);
    const float3 bent = bend_normal(shading, geometric, outgoing);
    cosines[3 * i] = dot_product(bent, outgoing);
    cosines[3 * i + 1] = dot_product(2.0f * dot_product(bent, outgoing) * bent - outgoing, geometric);
    cosines[3 * i + 2] = length_of(bent);
}
