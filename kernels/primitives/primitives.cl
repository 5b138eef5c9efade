// Kernels for primitives of one kind, whose text comes before this one (primitives/primitive.clh); alone it is for spheres.
#ifndef CLARAY_PRIMITIVE_KIND
#define CLARAY_PRIMITIVE_KIND
#define CLARAY_PRIMITIVES 1
#include "primitives/spheres.clh"
#endif
#include "primitives/traverse.clh"
#include "trace/query.clh"

#ifndef BRUTE_FORCE
#define BRUTE_FORCE 0  // 1: tests every primitive, without the tree
#endif

/// For the builder each primitive becomes a triangle that spans its box. Its corners are three different points, because the builder
/// leaves out triangles without area.
kernel void bound_primitives(global const float* data, uint count, global float* positions, global uint* indices) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const PrimitiveBox box = bounds_of(data, i);
    const float3 lo = box.lo;
    const bool valid = lo.x <= box.hi.x && lo.y <= box.hi.y && lo.z <= box.hi.z;
    const float3 least = fmax(fabs(lo), 1e-18f) * 0x1p-22f, hi = fmax(box.hi, (float3)(lo.xy + least.xy, lo.z));
    vstore3(valid ? lo : (float3)(NAN), 3 * i, positions);
    vstore3(hi, 3 * i + 1, positions);
    vstore3(PRIMITIVE_CAPSULES ? box.start : (float3)(lo.x, hi.y, lo.z), 3 * i + 2, positions);
    vstore3((uint3)(3 * i, 3 * i + 1, 3 * i + 2), i, indices);
}

static CLARAY_OUTLINED Hit trace_primitives(CLARAY_BVH_PARAMETERS, global const float* data, uint primitives, Ray ray, bool any) {
    Hit hit = no_hit(ray.tmax);
    if (!ray_valid(ray)) return hit;
    const PreparedRay prepared = prepare_ray(ray, false, 0xffffffffu);
    if (!BRUTE_FORCE) find_primitive(CLARAY_BVH, data, &prepared, any, &hit);
    else
        for (uint i = 0; i < primitives && !(any && hit.primitive != CLARAY_MISS); ++i) try_primitive(data, i, &prepared, &hit);
    return hit;
}

/// Second passes of queries of triangles: `hits` and `occluded` hold what rays meet among triangles. The numbers of primitives begin at
/// `lowest`. At equal distances the triangle stays.
#if INSTANCES
#include "claray/shared/instance.h"
#define FOUND_HIT InstanceHit
#else
#define FOUND_HIT Hit
#endif

kernel QUERY_GROUP
void nearer_primitive(CLARAY_BVH_PARAMETERS, global const float* data, uint primitives, global const Ray* rays, uint capacity,
                      global const uint* count, uint lowest, global FOUND_HIT* hits) {
    FOR_EACH_RAY(i, rays_to_trace(capacity, count)) {
        Ray ray = rays[i];
        ray.tmax = hits[i].t;
        const Hit hit = trace_primitives(CLARAY_BVH, data, primitives, ray, false);
        if (hit.primitive == CLARAY_MISS || (hit.t == ray.tmax && hits[i].primitive != CLARAY_MISS)) continue;
        hits[i].t = hit.t, hits[i].u = hit.u, hits[i].v = hit.v;
        hits[i].primitive = lowest + hit.primitive, hits[i].geometry = CLARAY_MISS;
#if INSTANCES
        hits[i].instance = CLARAY_MISS;
#endif
    }
}

kernel QUERY_GROUP
void occluding_primitive(CLARAY_BVH_PARAMETERS, global const float* data, uint primitives, global const Ray* rays, uint capacity,
                         global const uint* count, global uchar* occluded) {
    FOR_EACH_RAY(i, rays_to_trace(capacity, count)) {
        if (!occluded[i] && trace_primitives(CLARAY_BVH, data, primitives, rays[i], true).primitive != CLARAY_MISS) occluded[i] = 1;
    }
}

kernel QUERY_GROUP
void closest_primitive(CLARAY_BVH_PARAMETERS, global const float* data, uint primitives, global const Ray* rays, uint count,
                       global const uint* order, global Hit* hits) {
    FOR_EACH_RAY(i, count) {
        const uint mine = order ? order[i] : i;
        hits[mine] = trace_primitives(CLARAY_BVH, data, primitives, rays[mine], false);
    }
}

kernel QUERY_GROUP
void any_primitive(CLARAY_BVH_PARAMETERS, global const float* data, uint primitives, global const Ray* rays, uint count,
                   global const uint* order, global uchar* occluded) {
    FOR_EACH_RAY(i, count) {
        const uint mine = order ? order[i] : i;
        occluded[mine] = trace_primitives(CLARAY_BVH, data, primitives, rays[mine], true).primitive != CLARAY_MISS;
    }
}
