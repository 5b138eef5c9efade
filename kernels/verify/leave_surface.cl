// Rays that leave triangles, to be traced against them.
#undef NORMALS
#define NORMALS 0
#include "shade/surface_sixteen.clh"
#include "verify/leaving_rays.clh"

/// `clearance` is the rays' offset relative to the triangle's first edge. Item i belongs to triangle (first + i) / rays_each.
kernel void leave_surface_at_random(uint count, uint first, uint rays_each, uint seed, global const float* positions,
                                    global const uint* indices, global Ray* rays, global float* clearance) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const Leaving leaving = leaving_of(first + i, seed);
    const Hit hit = point_that_is_left(leaving, (first + i) / rays_each);
    const Surface s = surface_at(hit, view_of_leaving(leaving), positions, indices, 0);
    rays[i] = leaving_ray(leaving, &s);
    clearance[i] = s.clearance / length_of(load3(positions, indices[3 * hit.primitive + 1]) - s.base);
}

/// The same points by the 16-lane arithmetic of CPUs; item i handles rays 16 i .. 16 i + 15. `differ` counts, per item, the rays on
/// the viewer's side that differ from `rays`; it must be 0.
kernel void leave_surface_by_sixteen(uint count, uint rays_each, uint seed, global const float* positions, global const uint* indices,
                                     global const Ray* rays, global uint* differ) {
    const uint item = get_global_id(0);
    if (16 * item >= count) return;
    MetTriangle16 met;
    Lanes16 in;
    uint triangle[16];
    for (uint k = 0; k < 16; ++k) {
        const uint id = min(16 * item + k, count - 1);
        const Leaving leaving = leaving_of(id, seed);
        const Hit hit = point_that_is_left(leaving, id / rays_each);
        triangle[k] = hit.primitive;
        in.value[0][k] = hit.u, in.value[1][k] = hit.v;
        keep_vector16(view_of_leaving(leaving), &in, 2, k);
    }
    load_triangles16(triangle, positions, indices, 0, &met);
    met.u = lane_values16(&in, 0), met.v = lane_values16(&in, 1), met.outgoing = lane_vectors16(&in, 2);
    const Vectors from = plain_surfaces16(&met, false).leaving;
    Lanes16 out;
    keep_vectors16(from, &out, 0);
    uint wrong = 0;
    for (uint k = 0; k < 16 && 16 * item + k < count; ++k) {
        const Ray ray = rays[16 * item + k];
        if ((k & 1) != 0) wrong += out.value[0][k] != ray.ox || out.value[1][k] != ray.oy || out.value[2][k] != ray.oz;
    }
    differ[item] = wrong;
}
