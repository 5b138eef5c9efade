// tinybvh as a shared library, for tinybvh.py. Its layout of eight children per node is its fastest on CPUs with AVX2.
#include <atomic>
#include <thread>
#include <vector>

#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"

#ifdef LEAGUE_BEST
using Tree = tinybvh::BVH8_CPU;
#else
using Tree = tinybvh::BVH;
#endif

namespace {

tinybvh::Ray ray_of(const float* o, const float* d, float length) {
    return tinybvh::Ray(tinybvh::bvhvec3(o[0], o[1], o[2]), tinybvh::bvhvec3(d[0], d[1], d[2]), length);
}

template <class Body>
void in_parallel(unsigned rays, unsigned threads, Body body) {
    std::atomic<unsigned> next{0};
    const auto work = [&] {
        for (unsigned begin; (begin = next.fetch_add(1024)) < rays;)
            for (unsigned i = begin; i < std::min(begin + 1024, rays); ++i) body(i);
    };
    std::vector<std::thread> others;
    for (unsigned k = 1; k < threads; ++k) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
}

}  // namespace

extern "C" {

/// corners: four floats each, which must outlive the tree.
Tree* build(const tinybvh::bvhvec4* corners, unsigned triangles) {
    Tree* tree = new Tree();
    tree->Build(corners, triangles);
    return tree;
}

void closest(Tree* tree, const float* o, const float* d, float* t, unsigned* primitive, unsigned rays,
             unsigned threads) {
    in_parallel(rays, threads, [=](unsigned i) {
        tinybvh::Ray ray = ray_of(o + 3 * i, d + 3 * i, 1e30f);
        tree->Intersect(ray);
        t[i] = ray.hit.t;
        primitive[i] = ray.hit.prim;
    });
}

/// lengths: of the shadow rays.
void any_hit(Tree* tree, const float* o, const float* d, const float* lengths, unsigned* occluded, unsigned rays,
             unsigned threads) {
    in_parallel(rays, threads,
                [=](unsigned i) { occluded[i] = tree->IsOccluded(ray_of(o + 3 * i, d + 3 * i, lengths[i])); });
}
}
