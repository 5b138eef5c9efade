// The stage between two traces: shades hits (shade_hit.clh).
#include "claray/shared/lists/effects.h"
#include "render/layers/light_layers.clh"
#include "render/queues/ray_list.clh"
#include "render/queues/segments.clh"
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

/// 1: hits are shaded in groups, one stage after the other. Without optimization PoCL takes minutes to compile this. Light is split hit
/// by hit.
#if LIGHT_LAYERS
#define SHADE_GROUPS 0
#else
#define SHADE_GROUPS (CLARAY_CPU && !CLARAY_UNOPTIMIZED && !SHADE_SIXTEEN)
#endif
/// Turn rows of CLARAY_EFFECTS into terms of conditions: the scene has an effect without that form for sixteen rays.
#define CLARAY_NOT_SHADED(name, text, MACRO, bit, stages, lanes, traits) || (!((lanes) & CLARAY_LANES_SHADE) && MACRO)
#define CLARAY_NOT_LISTED(name, text, MACRO, bit, stages, lanes, traits) || (!((lanes) & CLARAY_LANES_LISTS) && MACRO)
#define CLARAY_OF_KIND(name, NAME, text, far, cone, rough)
#define CLARAY_OF_LIGHT(name, NAME, text, far, cone)
#define EFFECTS_WITHOUT_LANES(TERM) (0 CLARAY_EFFECTS(TERM, CLARAY_OF_KIND, CLARAY_OF_LIGHT, CLARAY_OF_KIND))
/// 1: surfaces have their own materials and their own points are lit.
#define PLAIN_TASK (!BAKE && !SHADING)
/// 1: shade_sixteen.clh shades the hits of plain materials; all hits, if there are no other materials.
#define PLAIN_IN_LANES                                                                                                       \
    (SIXTEEN && CLARAY_CPU && (USES(CLARAY_LAMBERT) || GLOSSY_IN_LANES) && PLAIN_TASK && \
     !EFFECTS_WITHOUT_LANES(CLARAY_NOT_SHADED))
/// 1: dielectrics and metals without coats and other layers count as plain.
#define GLOSSY_IN_LANES ((USES(CLARAY_PRINCIPLED) || USES(CLARAY_METAL) || USES(CLARAY_GLASS)) && !LIGHT_GRID && !AMBIENT)
/// 1: so does smooth glass.
#define GLASS_IN_LANES (GLOSSY_IN_LANES && USES(CLARAY_GLASS) && !BESIDE_SURFACES && CAUSTICS)
#define SHADE_SIXTEEN (PLAIN_IN_LANES && MATERIALS == 1u << CLARAY_LAMBERT && !TEXTURES)
#define SHADE_MIXED (PLAIN_IN_LANES && SHADE_GROUPS)
#if SHADE_SIXTEEN || SHADE_MIXED
#include "render/shade_sixteen.clh"
#endif

/// Rays that an item shades together, and for which it reserves room in the queues at once on CPUs. One atomic operation per ray,
/// on a counter and on cache lines of queues that two cores share, took a third of the time of shading.
#define SLOTS_AT_ONCE 16u

typedef struct ShadedRay {
    NextRay next;
    NextShadow shadow;
} ShadedRay;

/// Adds what a ray gathers to its path.
static inline void add_gathered(float3 gathered, uint path, global float* radiance) {
    if (gathered.x != 0.0f || gathered.y != 0.0f || gathered.z != 0.0f) add_radiance(radiance, path, gathered);
}

/// Notes for the path guide where a path goes.
static inline void note_next(const Step* step, uint path, const NextRay* next, global float* radiance) {
    if (PATH_GUIDE && teaches(&step->frame, step->depth))
        note_bin(step, path, next->wanted ? next->bin : ENDS_HERE, throughput_of(next->state), radiance);
}

#if SHADE_GROUPS
#include "render/groups/hit_group.clh"
#endif

/// Shades ray i of the queue and adds the light that it gathers to its path.
static inline void shade_ray(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, uint i,
                             global float* radiance, ShadedRay* shaded) {
    const uint depth = step->depth, room = step->room;
    const PathState state = queued_state(&states_of_queue(queue, room)[i]);
    const PathSegment segment = queued_segment(&step->frame, depth, queue, room, i);
    float3 gathered;
    if (PATH_GUIDE && teaches(&step->frame, depth)) note_light_before(step, state.path, radiance);
    shade_hit(step, depth, SCENE, segment, hits[i], state, radiance + 3 * (size_t)room, &gathered, &shaded->next, &shaded->shadow);
    add_gathered(gathered, state.path, radiance);
#if LIGHT_LAYERS
    split_light(step, SCENE, segment, hits[i], state, gathered, &shaded->next, &shaded->shadow, radiance);
#endif
    note_next(step, state.path, &shaded->next, radiance);
}

/// Shades the `count` rays of the queue with the numbers `rays`.
static inline void shade_rays(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, const uint* rays,
                              uint count, global float* radiance, ShadedRay* shaded) {
#if SHADE_GROUPS
    shade_rays16(step, SCENE, queue, hits, rays, count, radiance, shaded);
#else
    for (uint k = 0; k < count; ++k) shade_ray(step, SCENE, queue, hits, rays[k], radiance, &shaded[k]);
#endif
}

static inline void store_next(const ShadedRay* shaded, global RayQueue* queue, uint room, uint slot) {
    store_segment(shaded->next.segment, queue, room, slot);
    store_state(&states_of_queue(queue, room)[slot], shaded->next.state);
}

static inline void store_shadow(const ShadedRay* shaded, global ShadowQueue* queue, uint room, uint slot) {
    store_ray(&rays_of_shadows(queue)[slot], shaded->shadow.ray);
    store_light(&light_of_shadows(queue, room)[slot], shaded->shadow.light);
    if (INSTANCE_MOTION) times_of_shadows(queue, room)[slot] = shaded->next.segment.time;
}

#if CLARAY_CPU
#include "render/groups/batches.clh"
#endif

/// Shades the rays of `queue`, which met `depth` surfaces before this one. Fills the next queue and, under LIGHTS, the queue of
/// shadow rays; the lengths of both are 0 before. Adds the lengths of the previous bounce's queues to `totals` and sets them to 0,
/// so that these queues can be filled next. With a light tree, the paths' shading normals follow `radiance` in the same buffer.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void shade_surface(Step step, SCENE_PARAMETERS, global QueueLength* lengths, global ulong* totals,
                   global RayQueue* queue, global const SceneHit* hits, global RayQueue* next_queue,
                   global ShadowQueue* shadow_queue, global float* radiance RAY_LIST_PARAMETERS) {
    const uint depth = step.depth;
    const RayList list = RAY_LIST(step, lengths);
    if (IS_FIRST_SHADER && get_global_id(0) == 0)
        count_spent(length_of_rays(lengths, depth + 2), length_of_shadows(lengths, depth + 1), totals);
    global uint* next_length = length_of_rays(lengths, depth + 1);
    global uint* shadow_length = length_of_shadows(lengths, depth);
#if CLARAY_CPU
    const NextQueues to = {next_length, shadow_length, next_queue, shadow_queue};
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, list.count);
    shade_batches(&step, SCENE, queue, hits, list, begin, end, &to, radiance);
#else
    local uint scratch[2];
    ShadedRay shaded;
    shaded.next.wanted = shaded.shadow.wanted = false;
    const uint at = get_global_id(0);
    if (get_group_id(0) * GROUP_SIZE >= list.count) return;
    const uint number = number_in(list, min(at, list.count - 1u));
    if (at < list.count) shade_rays(&step, SCENE, queue, hits, &number, 1u, radiance, &shaded);
    const uint slot = reserve_slot(next_length, shaded.next.wanted, scratch);
    if (shaded.next.wanted) store_next(&shaded, next_queue, step.room, slot);
    if (!LIGHTS) return;
    const uint shadow_slot = reserve_slot(shadow_length, shaded.shadow.wanted, scratch);
    if (shaded.shadow.wanted) store_shadow(&shaded, shadow_queue, step.room, shadow_slot);
#endif
}
