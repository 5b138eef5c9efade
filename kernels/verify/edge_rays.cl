// Rays aimed at edges and vertices as exactly as float32 allows. Uses + - * only, so that all devices generate the same rays.
#include "claray/shared/rng.h"
#include "claray/shared/types.h"
#include "compute/portable.clh"

/// A number in [-1, 1).
static inline float both_ways(uint random) { return (float)(random >> 8) * 0x1p-23f - 1.0f; }

/// Ray i starts in the cube of half side `radius` around the centre and aims at a random vertex, or with `along_edges` at a random
/// point of a random edge.
kernel void edge_rays(uint count, uint first, uint seed, uint along_edges, float cx, float cy, float cz, float radius,
                      uint triangles, global const float* positions, global const uint* indices, global Ray* rays) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const uint id = first + i;
    const SamplePair a = independent_pair(id, hash_word(seed)), b = independent_pair(id, hash_word(seed + 1u));
    const SamplePair c = independent_pair(id, hash_word(seed + 2u));
    const uint triangle = a.x % triangles, corner = (a.y >> 8) % 3u;
    const float3 from = vload3(indices[3 * triangle + corner], positions);
    const float3 to = vload3(indices[3 * triangle + (corner + 1) % 3], positions);
    const float share = along_edges ? (float)(b.x >> 8) * 0x1p-24f : 0.0f;
    const float3 target = from + share * (to - from);
    const float3 origin = (float3)(cx, cy, cz) + radius * (float3)(both_ways(b.y), both_ways(c.x), both_ways(c.y));
    const float3 d = target - origin;
    const Ray ray = {origin.x, origin.y, origin.z, 0.0f, d.x, d.y, d.z, 1e30f};
    rays[i] = ray;
}
