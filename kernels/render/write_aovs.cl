// AOVs: data of the first surfaces that camera rays meet.
#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "shade/maps.clh"
#include "shade/scene.clh"

/// For the first `step.capacity` rays.
kernel void write_aovs(Step step, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits,
                       global const Visits* visits, global float* depth, global float* normal, global float* albedo,
                       global uint* primitive, global uint* visited) {
    const FrameData* frame = &step.frame;
    global const float* normals = TABLE(float, normals);
    global const uint* triangle_materials = TABLE(uint, triangle_materials);
    global const MaterialData* materials = TABLE(MaterialData, materials);
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
#if INSTANCES
    const Hit hit = hit_in_scene(hits[i], instances);
#else
    const Hit hit = hits[i];
#endif
    const bool missed = hit.primitive == CLARAY_MISS;
    primitive[i] = hit.primitive;
    visited[i] = visits[i].nodes + visits[i].triangles;
    depth[i] = missed ? INFINITY : hit.t;
    float3 shading = (float3)(0.0f), color = (float3)(0.0f);
    if (!missed) {
        const Ray ray = rays[i];
        const float3 outgoing = -(float3)(ray.dx, ray.dy, ray.dz);
        MaterialData material = materials[triangle_materials[hit.primitive]];
#if INSTANCES
        const Placement placement = placement_of(hits[i].instance, 0.0f INSTANCE_BUFFERS);
        Surface surface = surface_of_instance(hit, &placement, outgoing, positions, indices, normals);
#else
        Surface surface = surface_at(hit, outgoing, positions, indices, normals);
#endif
#if VERTEX_COLORS
        if (textures) apply_vertex_colors(textures, indices, hit, &material);
#endif
#if TEXTURES
        if (textures)
            apply_maps(textures, triangle_materials[hit.primitive], indices, hit, outgoing, 0.0f, &surface, &material);
#endif
        shading = surface.shading;
        // Denoisers expect values from 0 to 1 that differ between surfaces, including lamps.
        color = (float3)(material.albedo_r, material.albedo_g, material.albedo_b);
        color = fmin(color + (float3)(material.emission_r, material.emission_g, material.emission_b), 1.0f);
    }
    vstore3(shading, i, normal);
    vstore3(color, i, albedo);
}
