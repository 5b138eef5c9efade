// AOVs: data of the first surfaces that camera rays meet.
#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "shade/seen_surface.clh"

/// The normal and the color of the surface that a ray meets.
static CLARAY_OUTLINED void look_at(const FrameData* frame, SCENE_PARAMETERS, Ray ray, SceneHit found, Hit hit, float3* shading, float3* color) {
    Surface surface;
    MaterialData material;
    find_seen_surface(frame, SCENE, ray, found, hit, &surface, &material);
    *shading = surface.shading;
    // Denoisers expect values from 0 to 1 that differ between surfaces, including lamps.
    *color = (float3)(material.albedo_r, material.albedo_g, material.albedo_b);
    *color = fmin(*color + (float3)(material.emission_r, material.emission_g, material.emission_b), 1.0f);
}

/// For the first `step.capacity` rays.
kernel void write_aovs(Step step, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits,
                       global const Visits* visits, global float* depth, global float* normal, global float* albedo,
                       global uint* primitive, global uint* visited) {
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    const Hit hit = seen_hit(hits[i] INSTANCE_BUFFERS);
    const bool missed = hit.primitive == CLARAY_MISS;
    primitive[i] = hit.primitive;
    visited[i] = visits[i].nodes + visits[i].triangles;
    depth[i] = missed ? INFINITY : hit.t;
    float3 shading = (float3)(0.0f), color = (float3)(0.0f);
    if (!missed) look_at(&step.frame, SCENE, rays[i], hits[i], hit, &shading, &color);
    vstore3(shading, i, normal);
    vstore3(color, i, albedo);
}
