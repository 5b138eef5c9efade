// The stage between two traces: shades hits (shade_hit.clh).
#include "render/queue.clh"
#include "render/shade_hit.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif
#ifndef PATHS_PER_ITEM
#define PATHS_PER_ITEM 64  // consecutive rays that an item shades on CPUs; 1 on GPUs
#endif
#ifndef SIXTEEN
#define SIXTEEN 1  // 1: sixteen rays at once if the scene allows it
#endif

/// 1: shade_sixteen.clh shades the hits.
#define SHADE_SIXTEEN                                                                                                      \
    (SIXTEEN && CLARAY_CPU && MATERIALS == 1u << CLARAY_LAMBERT && !NORMALS && !TEXTURES && !MIPMAPS && !INSTANCES && !BAKE && !SHADING && \
     !VERTEX_COLORS && !ENVIRONMENT && LIGHT_KINDS_USED == POINT_LIGHTS && !LIGHT_FALLOFF && !ABSORPTION &&                 \
     !(TRIANGLE_LIGHTS && POINT_LIGHTS))
#if SHADE_SIXTEEN
#include "render/shade_sixteen.clh"
#endif

/// Shades the rays of `queue`, which met `depth` surfaces before this one. Fills the next queue and, under LIGHTS, the queue of
/// shadow rays; the lengths of both are 0 before. Adds the lengths of the previous bounce's queues to `totals` and sets them to 0,
/// so that these queues can be filled next. With a light tree, the paths' shading normals follow `radiance` in the same buffer.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void shade_surface(Step step, SCENE_PARAMETERS, global QueueLength* lengths, global ulong* totals,
                   global RayQueue* queue, global const SceneHit* hits, global RayQueue* next_queue,
                   global ShadowQueue* shadow_queue, global float* radiance) {
    const uint depth = step.depth, room = step.room;
    if (get_global_id(0) == 0)
        count_spent(length_of_rays(lengths, depth + 2), length_of_shadows(lengths, depth + 1), totals);
    const uint all = min(*length_of_rays(lengths, depth), step.capacity);
    global uint* next_length = length_of_rays(lengths, depth + 1);
    global uint* shadow_length = length_of_shadows(lengths, depth);
    global float* shading_normals = radiance + 3 * (size_t)room;
#if SHADE_SIXTEEN
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
    Shaded16 shaded;
    for (uint i = begin; i < end; i += 16) {
        shade_sixteen(&step, SCENE, rays_of_queue(queue), hits, states_of_queue(queue, room), i, min(16u, end - i), radiance,
                      shading_normals, &shaded);
        store_next16(&shaded, next_length, rays_of_queue(next_queue), states_of_queue(next_queue, room));
        store_shadows16(&shaded, shadow_length, rays_of_shadows(shadow_queue), light_of_shadows(shadow_queue, room));
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
            const PathState state = state_of_ray(states_of_queue(queue, room), depth, i);
            RayCone cone = camera_cone(&step.frame);
#if MIPMAPS
            if (depth != 0) cone = cones_of_queue(queue, room)[i];
#endif
#if INSTANCE_MOTION
            time = times_of_queue(queue, room)[i];
#endif
            shade_hit(&step, depth, SCENE, queued_ray(&rays_of_queue(queue)[i]), hits[i], time, state, cone, shading_normals,
                      &gathered, &next, &shadow);
            if (gathered.x != 0.0f || gathered.y != 0.0f || gathered.z != 0.0f) add_radiance(radiance, state.path, gathered);
        }

        const uint slot = RESERVE_SLOT(next_length, next.wanted, scratch);
        if (next.wanted) {
            store_ray(&rays_of_queue(next_queue)[slot], next.ray);
            states_of_queue(next_queue, room)[slot] = next.state;
#if INSTANCE_MOTION
            times_of_queue(next_queue, room)[slot] = time;
#endif
#if MIPMAPS
            cones_of_queue(next_queue, room)[slot] = next.cone;
#endif
        }
#if LIGHTS
        const uint shadow_slot = RESERVE_SLOT(shadow_length, shadow.wanted, scratch);
        if (shadow.wanted) {
            store_ray(&rays_of_shadows(shadow_queue)[shadow_slot], shadow.ray);
            store_light(&light_of_shadows(shadow_queue, room)[shadow_slot], shadow.light);
#if INSTANCE_MOTION
            times_of_shadows(shadow_queue, room)[shadow_slot] = time;
#endif
        }
#endif
    }
#endif
}
