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
#else

/// Rays for which an item reserves room in the queues at once on CPUs. One atomic operation per ray, on a counter and on cache lines
/// of queues that two cores share, took a third of the time of shading.
#define SLOTS_AT_ONCE 16u

typedef struct ShadedRay {
    NextRay next;
    NextShadow shadow;
    float time;  // under INSTANCE_MOTION
} ShadedRay;

/// Shades ray i of the queue and adds the light that it gathers to its path.
static inline void shade_ray(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, uint i,
                             global float* radiance, ShadedRay* shaded) {
    const uint depth = step->depth, room = step->room;
    const PathState state = state_of_ray(states_of_queue(queue, room), depth, i);
    RayCone cone = camera_cone(&step->frame);
#if MIPMAPS
    if (depth != 0) cone = cones_of_queue(queue, room)[i];
#endif
    shaded->time = 0.0f;
#if INSTANCE_MOTION
    shaded->time = times_of_queue(queue, room)[i];
#endif
    float3 gathered;
    shade_hit(step, depth, SCENE, queued_ray(&rays_of_queue(queue)[i]), hits[i], shaded->time, state, cone,
              radiance + 3 * (size_t)room, &gathered, &shaded->next, &shaded->shadow);
    if (gathered.x != 0.0f || gathered.y != 0.0f || gathered.z != 0.0f) add_radiance(radiance, state.path, gathered);
}

static inline void store_next(const ShadedRay* shaded, global RayQueue* queue, uint room, uint slot) {
    store_ray(&rays_of_queue(queue)[slot], shaded->next.ray);
    states_of_queue(queue, room)[slot] = shaded->next.state;
#if INSTANCE_MOTION
    times_of_queue(queue, room)[slot] = shaded->time;
#endif
#if MIPMAPS
    cones_of_queue(queue, room)[slot] = shaded->next.cone;
#endif
}

static inline void store_shadow(const ShadedRay* shaded, global ShadowQueue* queue, uint room, uint slot) {
    store_ray(&rays_of_shadows(queue)[slot], shaded->shadow.ray);
    store_light(&light_of_shadows(queue, room)[slot], shaded->shadow.light);
#if INSTANCE_MOTION
    times_of_shadows(queue, room)[slot] = shaded->time;
#endif
}
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
#if SHADE_SIXTEEN
    global float* shading_normals = radiance + 3 * (size_t)room;
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
    Shaded16 shaded;
    for (uint i = begin; i < end; i += 16) {
        shade_sixteen(&step, SCENE, rays_of_queue(queue), hits, states_of_queue(queue, room), i, min(16u, end - i), radiance,
                      shading_normals, &shaded);
        store_next16(&shaded, next_length, rays_of_queue(next_queue), states_of_queue(next_queue, room));
        store_shadows16(&shaded, shadow_length, rays_of_shadows(shadow_queue), light_of_shadows(shadow_queue, room));
    }
#elif CLARAY_CPU
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
    for (uint i = begin; i < end; i += SLOTS_AT_ONCE) {
        ShadedRay shaded[SLOTS_AT_ONCE];
        const uint count = min(SLOTS_AT_ONCE, end - i);
        uint rays = 0, shadows = 0;
        for (uint k = 0; k < count; ++k) {
            shade_ray(&step, SCENE, queue, hits, i + k, radiance, &shaded[k]);
            rays += shaded[k].next.wanted, shadows += shaded[k].shadow.wanted;
        }
        uint slot = rays ? atomic_add(next_length, rays) : 0u;
        for (uint k = 0; k < count; ++k)
            if (shaded[k].next.wanted) store_next(&shaded[k], next_queue, room, slot++);
#if LIGHTS
        slot = shadows ? atomic_add(shadow_length, shadows) : 0u;
        for (uint k = 0; k < count; ++k)
            if (shaded[k].shadow.wanted) store_shadow(&shaded[k], shadow_queue, room, slot++);
#endif
    }
#else
    local uint scratch[2];
    ShadedRay shaded;
    shaded.next.wanted = shaded.shadow.wanted = false;
    if (get_global_id(0) < all) shade_ray(&step, SCENE, queue, hits, get_global_id(0), radiance, &shaded);
    const uint slot = reserve_slot(next_length, shaded.next.wanted, scratch);
    if (shaded.next.wanted) store_next(&shaded, next_queue, room, slot);
#if LIGHTS
    const uint shadow_slot = reserve_slot(shadow_length, shaded.shadow.wanted, scratch);
    if (shaded.shadow.wanted) store_shadow(&shaded, shadow_queue, room, shadow_slot);
#endif
#endif
}
