// tinybvh's own BVH as a shared library: tinybvh.py compiles and calls it.
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"

extern "C" {

/// corners: four floats each, which must outlive the tree.
tinybvh::BVH* build(const tinybvh::bvhvec4* corners, unsigned triangles) { return new tinybvh::BVH(corners, triangles); }

void closest_hit(tinybvh::BVH* tree, const float* o, const float* d, float* t, unsigned* primitive, unsigned rays) {
    for (unsigned i = 0; i < rays; ++i, o += 3, d += 3) {
        tinybvh::Ray ray(tinybvh::bvhvec3(o[0], o[1], o[2]), tinybvh::bvhvec3(d[0], d[1], d[2]));
        tree->Intersect(ray);
        t[i] = ray.hit.t;
        primitive[i] = ray.hit.prim;
    }
}
}
