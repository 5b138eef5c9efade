// The stage between two traces: see shade_hit.clh for what is done with one hit.
#include "render/queue.clh"
#include "render/shade_hit.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif
#ifndef PATHS_PER_ITEM
#define PATHS_PER_ITEM 64  // consecutive rays that an item shades, on CPUs; on GPUs 1
#endif
#ifndef SIXTEEN
#define SIXTEEN 1  // 1: sixteen rays at once where that can be
#endif

/// Where shade_sixteen.clh does the work.
#define SHADE_SIXTEEN                                                                                                      \
    (SIXTEEN && CLARAY_CPU && MATERIALS == 1u << CLARAY_LAMBERT && !NORMALS && !TEXTURES && !MIPMAPS && !INSTANCES && !BAKE && \
     !VERTEX_COLORS && !ENVIRONMENT && !SPOT_LIGHTS && !DIRECTIONAL_LIGHTS && !LIGHT_FALLOFF && !ABSORPTION &&                 \
     !(TRIANGLE_LIGHTS && POINT_LIGHTS))
#if SHADE_SIXTEEN
#include "render/shade_sixteen.clh"
#endif

/// Shades the first *length rays, which have met `depth` surfaces before this one. Fills the next queue and, under LIGHTS, the queue of
/// shadow rays; both lengths begin at 0. The queues that the bounce before has worked off, of rays and of shadow rays, are
/// counted in `totals` and emptied, so that they can be filled after this one.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void shade_surface(Batch batch, FrameData frame, uint depth, SCENE_PARAMETERS, global const uint* length, uint capacity,
                   global const Ray* rays, global const SceneHit* hits, global const PathState* states, global float* radiance,
                   global float* shading_normals,
                   global uint* next_length, global Ray* next_rays, global PathState* next_states,
                   global uint* shadow_length, global Ray* shadow_rays, global LightSample* shadow_light,
                   global const RayCone* cones, global RayCone* next_cones, global uint* spent,
                   global uint* shadows_spent, global ulong* totals TIME_PARAMETERS) {
    if (get_global_id(0) == 0) count_spent(spent, shadows_spent, totals);
    const uint all = min(*length, capacity);
#if SHADE_SIXTEEN
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
    Shaded16 shaded;
    for (uint i = begin; i < end; i += 16) {
        shade_sixteen(batch, frame, depth, SCENE, rays, hits, states, i, min(16u, end - i), radiance, shading_normals, &shaded);
        store_next16(&shaded, next_length, next_rays, next_states);
        store_shadows16(&shaded, shadow_length, shadow_rays, shadow_light);
    }
#else
#if CLARAY_CPU
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
    for (uint i = begin; i < end; ++i)
#else
    local uint scratch[2];
    const uint i = get_global_id(0);
#endif
    {
        NextRay next;
        NextShadow shadow;
        float3 gathered;
        next.wanted = shadow.wanted = false;
        float time = 0.0f;
        if (i < all) {
            const PathState state = state_of_ray(states, depth, i);
            RayCone cone = camera_cone(frame);
#if MIPMAPS
            if (cones && depth != 0) cone = cones[i];
#endif
#if INSTANCE_MOTION
            time = times[i];
#endif
            shade_hit(batch, frame, depth, SCENE, queued_ray(&rays[i]), hits[i], time, state, cone, shading_normals, &gathered,
                      &next, &shadow);
            if (gathered.x != 0.0f || gathered.y != 0.0f || gathered.z != 0.0f) add_radiance(radiance, state.path, gathered);
        }

        const uint slot = RESERVE_SLOT(next_length, next.wanted, scratch);
        if (next.wanted) {
            store_ray(&next_rays[slot], next.ray);
            next_states[slot] = next.state;
#if INSTANCE_MOTION
            next_times[slot] = time;
#endif
#if MIPMAPS
            if (next_cones) next_cones[slot] = next.cone;
#endif
        }
#if LIGHTS
        const uint shadow_slot = RESERVE_SLOT(shadow_length, shadow.wanted, scratch);
        if (shadow.wanted) {
            store_ray(&shadow_rays[shadow_slot], shadow.ray);
            store_light(&shadow_light[shadow_slot], shadow.light);
#if INSTANCE_MOTION
            shadow_times[shadow_slot] = time;
#endif
        }
#endif
    }
#endif
}
