// AOVs: data of the first surfaces that camera rays meet.
#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "shade/surface_at_hit.clh"

/// The normal and the color of the surface that a ray meets.
static CLARAY_OUTLINED void look_at(const FrameData* frame, SCENE_PARAMETERS, Ray ray, SceneHit found, float3* shading, float3* color) {
    ShadingPoint at;
    surface_seen(frame, SCENE, ray, found, &at);
    *shading = at.surface.shading;
    // Denoisers expect values from 0 to 1 that differ between surfaces, including lamps.
    const float3 emission = (float3)(at.material.emission_r, at.material.emission_g, at.material.emission_b);
    *color = fmin(albedo_of(&at.material) + emission, 1.0f);
}

/// For the first `step.capacity` rays.
kernel void write_aovs(Step step, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits,
                       global const Visits* visits, global float* depth, global float* normal, global float* albedo,
                       global uint* primitive, global uint* visited) {
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    const Hit hit = hit_of(hits[i] INSTANCE_BUFFERS);
    const bool missed = hit.primitive == CLARAY_MISS;
    primitive[i] = hit.primitive;
    visited[i] = visits[i].nodes + visits[i].triangles;
    depth[i] = missed ? INFINITY : hit.t;
    float3 shading = (float3)(0.0f), color = (float3)(0.0f);
    if (!missed) look_at(&step.frame, SCENE, rays[i], hits[i], &shading, &color);
    vstore3(shading, i, normal);
    vstore3(color, i, albedo);
}
