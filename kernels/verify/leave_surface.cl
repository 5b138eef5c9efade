// Rays that leave random points of triangles for random directions on either side, some of them grazing.
#ifndef NORMALS
#define NORMALS 0
#endif
#include "claray/shared/rng.h"
#include "shade/surface.clh"

/// `clearance` is where rays begin, relative to the triangle's first edge. Item i belongs to triangle (first + i) / rays_each.
kernel void leave_surface_at_random(uint count, uint first, uint rays_each, uint seed, global const float* positions,
                                    global const uint* indices, global Ray* rays, global float* clearance) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const uint id = first + i;
    const SamplePair a = independent_pair(id, hash_word(seed)), b = independent_pair(id, hash_word(seed + 1u));
    const SamplePair c = independent_pair(id, hash_word(seed + 2u));
    const float root = sqrt(unit_float(a.x));
    const Hit hit = {0.0f, root * (1.0f - unit_float(a.y)), root * unit_float(a.y), id / rays_each, 0u};
    const float3 view = (float3)(unit_float(b.x), unit_float(b.y), unit_float(c.x)) - 0.5f;
    const Surface s = surface_at(hit, normalize(view), positions, indices, 0);
    const bool viewers_side = id & 1;
    float3 d = normalize((float3)(unit_float(c.x), unit_float(c.y), unit_float(a.x)) - 0.5f);
    if ((dot(d, s.geometric) > 0.0f) != viewers_side) d = -d;
    if (id % 8 == 0) d = normalize(d - 0.999f * dot(d, s.geometric) * s.geometric);  // grazing
    const float3 o = leave_surface(&s, viewers_side);
    const Ray ray = {o.x, o.y, o.z, 0.0f, d.x, d.y, d.z, INFINITY};
    rays[i] = ray;
    clearance[i] = s.clearance / length(load3(positions, indices[3 * hit.primitive + 1]) - s.base);
}
