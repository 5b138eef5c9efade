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

/// 1: hits are shaded in groups, one stage after the other. Without optimization PoCL takes minutes to compile this.
#define SHADE_GROUPS (CLARAY_CPU && !CLARAY_UNOPTIMIZED)
/// 1: shade_sixteen.clh shades the hits of plain materials; all hits, if there are no other materials.
#define PLAIN_IN_LANES                                                                                                     \
    (SIXTEEN && CLARAY_CPU && USES(CLARAY_LAMBERT) && !TEXTURES && !MIPMAPS && !INSTANCES && !PRIMITIVES && !BAKE && !SHADING && \
     !VERTEX_COLORS && !NESTED_MEDIA && LIGHT_KINDS_USED == POINT_LIGHTS && !LIGHT_FALLOFF && !LISTED_LIGHTS && !(TRIANGLE_LIGHTS && POINT_LIGHTS))
#define SHADE_SIXTEEN (PLAIN_IN_LANES && MATERIALS == 1u << CLARAY_LAMBERT)
#define SHADE_MIXED (PLAIN_IN_LANES && SHADE_GROUPS && !SHADE_SIXTEEN)
#if SHADE_SIXTEEN || SHADE_MIXED
#include "render/shade_sixteen.clh"
#endif
#if !SHADE_SIXTEEN
#if SHADE_GROUPS
#include "lights/light_lists_sixteen.clh"
#include "shade/surface_sixteen.clh"
#endif
/// 1: surfaces of plain materials that no path leaves are found by vectors.
#if SHADE_GROUPS && LISTED_LIGHTS && !TEXTURES && !INSTANCES && !VERTEX_COLORS && !ABSORPTION && !NESTED_MEDIA && !AMBIENT && !BAKE && !SHADING && !LIGHT_GRID
#define PLAIN_SIXTEEN USES(CLARAY_LAMBERT)
#else
#define PLAIN_SIXTEEN 0
#endif

/// Rays that an item shades together, and for which it reserves room in the queues at once on CPUs. One atomic operation per ray,
/// on a counter and on cache lines of queues that two cores share, took a third of the time of shading.
#define SLOTS_AT_ONCE 16u
#ifndef STRIP_ROWS
#define STRIP_ROWS 32u
#endif

typedef struct ShadedRay {
    NextRay next;
    NextShadow shadow;
    float time;  // under INSTANCE_MOTION
} ShadedRay;

/// Adds what a ray gathers to its path.
static inline void add_gathered(float3 gathered, uint path, global float* radiance) {
    if (gathered.x != 0.0f || gathered.y != 0.0f || gathered.z != 0.0f) add_radiance(radiance, path, gathered);
}

/// Notes for the path guide where a path goes.
static inline void note_next(const Step* step, uint path, const NextRay* next, global float* radiance) {
#if PATH_GUIDE
    if (teaches(&step->frame, step->depth)) note_bin(step, path, next->wanted ? next->bin : ENDS_HERE, throughput_of(next->state), radiance);
#endif
}

static inline float time_in_queue(global RayQueue* queue, uint room, uint i) {
#if INSTANCE_MOTION
    return times_of_queue(queue, room)[i];
#else
    return 0.0f;
#endif
}

static inline RayCone cone_of_ray(const FrameData* frame, uint depth, global RayQueue* queue, uint room, uint i) {
#if MIPMAPS
    if (depth != 0) return cones_of_queue(queue, room)[i];
#endif
    return camera_cone(frame);
}

#if SHADE_GROUPS
/// Hits that are shaded together, one stage after the other for all of them.
typedef struct HitGroup {
    uint scattering;  // the lanes that scatter
    Ray ray[SLOTS_AT_ONCE];
    PathState state[SLOTS_AT_ONCE];
    ShadingPoint at[SLOTS_AT_ONCE];
    SurfaceSamples samples[SLOTS_AT_ONCE];
    float lobe[SLOTS_AT_ONCE];
    ListPick listed[SLOTS_AT_ONCE];
    uint picked;  // the lanes with a light in `listed`
    uint plain;   // those of them whose light is sampled by vectors
    Lanes16 lanes;
} HitGroup;

/// samples_at for all paths of the group: pairs `first` to `end` - 1, perhaps only the first number of each.
static inline void draw_samples16(const Step* step, uint first, uint end, bool pairs_wanted, HitGroup* group) {
    uint pixel[16], number[16], words[16];
    for (uint k = 0; k < 16; ++k) pixel[k] = group->state[k].pixel, number[k] = group->state[k].sample;
    const uint16 seeds = hash_words16(vload16(0, pixel), (uint16)(step->frame.seed)), numbers = vload16(0, number);
    for (uint which = first; which < end; ++which) {
        const uint dimension = which == AT_LOBE ? DIMENSION_LOBE(step->depth) : DIMENSION_LIGHT(step->depth) + which;
        const SamplePair16 pairs = sample_pair16(SAMPLER, seeds, numbers, (uint16)(dimension));
        vstore16(pairs.x, 0, words);
        for (uint k = 0; k < 16; ++k) ((uint*)&group->samples[k].x)[which] = words[k];
        if (!pairs_wanted) continue;
        vstore16(pairs.y, 0, words);
        for (uint k = 0; k < 16; ++k) ((uint*)&group->samples[k].y)[which] = words[k];
    }
}

#if LISTED_LIGHTS
/// Keeps a surface that asks the lists for a light.
static inline void keep_listed(const ShadingPoint* at, float random, HitGroup* group, uint k) {
    float3 from;
    group->lanes.value[ROW_LIST_LIFTED][k] = leave_for_light(&at->surface, true, &from) ? 1.0f : 0.0f;
    keep_vector16(from, &group->lanes, ROW_LIST_FROM, k);
    keep_vector16(receiving_normal(at), &group->lanes, ROW_LIST_NORMAL, k);
    group->lanes.value[ROW_LIST_RANDOM][k] = random;
    group->picked |= 1u << k;
}

static inline bool asks_lists(const LightsData* lights, const HitGroup* group, uint k) {
    return picks_from_lists(lights, words_at(&group->samples[k], AT_LIGHT).x) && !goes_to_hot_spot(group->state[k].flags);
}

/// Keeps a plain surface that asks the lists. Returns false for others. Paths that hot spots might have found as well are not kept.
static inline bool keep_plain(const LightsData* lights, const ShadingPoint* at, HitGroup* group, uint k) {
    const PathState* state = &group->state[k];
    if (!is_plain(&at->material) || !asks_lists(lights, group, k) || (state->pdf != 0.0f && lights->hot_spots != 0)) return false;
    keep_listed(at, share_in_lists(lights, words_at(&group->samples[k], AT_LIGHT).x), group, k);
    keep_vector16(at->surface.geometric, &group->lanes, ROW_LIST_GEOMETRIC, k);
    keep_vector16(throughput_of(*state) * albedo_of(&at->material), &group->lanes, ROW_LIST_REFLECTED, k);
    group->plain |= 1u << k;
    return true;
}

#if PLAIN_SIXTEEN
/// keep_plain by vectors, for the lanes of a mask. Returns the lanes that were kept.
static inline uint keep_plain16(const FrameData* frame, const LightsData* lights, SCENE_PARAMETERS, global const SceneHit* hits, const uint* rays, uint lanes,
                                HitGroup* group) {
    global const float* normals = TABLE(float, normals);
    MetTriangle16 met;
    Lanes16 rows = {{{0.0f}}};  // weights of vertices, and directions to viewers
    uint triangle[16] = {0u};
    for (uint left = lanes; left != 0; left &= left - 1) {
        const uint k = lowest_bit(left);
        const SceneHit hit = hits[rays[k]];
        const PathState* state = &group->state[k];
        if (hit.primitive == CLARAY_MISS || !asks_lists(lights, group, k) || (state->pdf != 0.0f && lights->hot_spots != 0)) continue;
        global const MaterialData* material = plain_material_at(frame, tables, hit);
        const float3 emission = (float3)(material->emission_r, material->emission_g, material->emission_b);
        if (material->kind != CLARAY_LAMBERT || material->layers != 0u || largest(emission) > 0.0f) continue;
        triangle[k] = hit.primitive;
        rows.value[0][k] = hit.u, rows.value[1][k] = hit.v;
        keep_vector16(-(float3)(group->ray[k].dx, group->ray[k].dy, group->ray[k].dz), &rows, 2, k);
        const float3 albedo = (float3)(material->albedo_r, material->albedo_g, material->albedo_b);
        keep_vector16(throughput_of(*state) * albedo, &group->lanes, ROW_LIST_REFLECTED, k);
        group->lanes.value[ROW_LIST_RANDOM][k] = share_in_lists(lights, words_at(&group->samples[k], AT_LIGHT).x);
        group->plain |= 1u << k;
    }
    group->picked = group->plain;
    load_triangles16(triangle, positions, indices, normals, &met);
    met.u = lane_values16(&rows, 0), met.v = lane_values16(&rows, 1), met.outgoing = lane_vectors16(&rows, 2);
    const PlainSurfaces16 surfaces = plain_surfaces16(&met, normals != 0);
    keep_vectors16(surfaces.from, &group->lanes, ROW_LIST_FROM);
    keep_vectors16(surfaces.normal, &group->lanes, ROW_LIST_NORMAL);
    keep_vectors16(surfaces.geometric, &group->lanes, ROW_LIST_GEOMETRIC);
    vstore16(select((float16)(0.0f), (float16)(1.0f), surfaces.lifted), 0, group->lanes.value[ROW_LIST_LIFTED]);
    return group->plain;
}
#endif

/// Picks lights for the surfaces that ask the lists, and samples those of plain ones.
static inline void pick_lights16(const Lights* lights, HitGroup* group, ShadedRay* shaded) {
    for (uint left = group->scattering & ~group->plain; left != 0; left &= left - 1) {
        const uint k = lowest_bit(left);
        if (asks_lists(&lights->data, group, k) && !is_delta(&group->at[k].material))
            keep_listed(&group->at[k], share_in_lists(&lights->data, words_at(&group->samples[k], AT_LIGHT).x), group, k);
    }
    global const PunctualLight* listed_lights = lights->punctual + lights->data.first_listed;
    pick_from_lists16(lights->lists, listed_lights, &group->lanes, group->picked, group->listed);
    Lanes16 seen;
    uint wanted = light_from_picks16(listed_lights, lights->data.grid_probability, &group->lanes, group->plain, group->listed, &seen);
    for (; wanted != 0; wanted &= wanted - 1) {
        const uint k = lowest_bit(wanted);
        const float3 light = lane_vector16(&seen, ROW_LISTED_LIGHT, k);
        const LightSample sample = {light.x, light.y, light.z, group->state[k].path};
        shaded[k].shadow.wanted = true, shaded[k].shadow.light = sample;
        shaded[k].shadow.ray = make_ray(lane_vector16(&group->lanes, ROW_LIST_FROM, k), lane_vector16(&seen, ROW_TOWARDS_LISTED, k), 1.0f);
    }
}
#endif

#if ENVIRONMENT
/// Gathers the light of the lanes of a mask that met nothing, and returns these lanes. Texels are requested for all of them before one is
/// used, and those of the others' light samples, if wanted: a large image is not in the cache.
static inline uint see_environment16(const FrameData* frame, const Lights* lights, global const SceneHit* hits, const uint* rays, uint lanes,
                                     bool samples, const HitGroup* group, float3* gathered) {
    const EnvironmentData image = lights->data.environment;
    if (image.width == 0) return 0u;
    EnvironmentPlace places[SLOTS_AT_ONCE];
    SamplePair words[SLOTS_AT_ONCE];
    float2 rest[SLOTS_AT_ONCE];
    uint misses = 0;
    for (uint left = lanes; left != 0; left &= left - 1) {
        const uint k = lowest_bit(left);
        words[k] = words_at(&group->samples[k], AT_LIGHT);
        if (hits[rays[k]].primitive != CLARAY_MISS) continue;
        misses |= 1u << k;
        places[k] = environment_place(image, (float3)(group->ray[k].dx, group->ray[k].dy, group->ray[k].dz));
        prefetch_cell(image, lights->texels, places[k].column, places[k].row);
    }
    if (samples) pick_environment16(lights, words, lanes & ~misses, rest);
    for (uint left = misses; left != 0; left &= left - 1) {
        const uint k = lowest_bit(left);
        const float3 direction = (float3)(group->ray[k].dx, group->ray[k].dy, group->ray[k].dz);
        gathered[k] = radiance_beyond(frame, lights, direction, &places[k], group->state[k]);
    }
    return misses;
}
#endif

/// Shades the `count` rays of the queue with the numbers `rays`, at most 16.
static CLARAY_OUTLINED void shade_rays16(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, const uint* rays,
                                uint count, global float* radiance, ShadedRay* shaded) {
    const FrameData* frame = &step->frame;
    const uint depth = step->depth, room = step->room;
    global float* shading_normals = radiance + 3 * (size_t)room;
    const Lights lights = lights_of(frame, SCENE);
    LastTriangle last = {CLARAY_MISS, (float3)(0.0f), CLARAY_NO_MAP, (float4)(0.0f)};
    HitGroup group;
    float3 gathered[SLOTS_AT_ONCE];
    group.scattering = group.picked = group.plain = 0;
    for (uint k = 0; k < SLOTS_AT_ONCE; ++k)
        group.state[k] = queued_state(&states_of_queue(queue, room)[rays[min(k, count - 1)]]);
    const bool plain = PLAIN_SIXTEEN && depth + 1 >= step->waves && lights.data.grid_probability > 0.0f;  // hardly a lane scatters
    draw_samples16(step, AT_LIGHT, AT_LIGHT + 1, !plain, &group);
    for (uint k = 0; k < count; ++k) {
        group.ray[k] = queued_ray(&rays_of_queue(queue)[rays[k]]);
        shaded[k].next.wanted = shaded[k].shadow.wanted = false;
        shaded[k].time = time_in_queue(queue, room, rays[k]);
        gathered[k] = (float3)(0.0f);
#if PATH_GUIDE
        if (teaches(frame, depth)) note_light_before(step, group.state[k].path, radiance);
#endif
    }
    uint others = (1u << count) - 1u;
#if ENVIRONMENT
    others &= ~see_environment16(frame, &lights, hits, rays, others, !plain && depth < frame->max_depth, &group, gathered);
#endif
#if PLAIN_SIXTEEN
    if (plain) others &= ~keep_plain16(frame, &lights.data, SCENE, hits, rays, others, &group);
#endif
    for (uint left = others; left != 0; left &= left - 1) {
        const uint k = lowest_bit(left), i = rays[k];
        const RayCone cone = cone_of_ray(frame, depth, queue, room, i);
        const Media media = media_of_ray(depth, queue, room, i);
        if (!find_point(&last, step, &lights, depth, SCENE, &group.ray[k], hits[i], shaded[k].time, cone, media, shading_normals,
                        &group.state[k], &gathered[k], &group.at[k]))
            continue;
#if LISTED_LIGHTS
        const bool ends = !LIGHT_GRID && depth + 1 >= step->waves;  // no path goes on
        if (keep_plain(&lights.data, &group.at[k], &group, k) && ends) continue;
#endif
        group.scattering |= 1u << k;
    }
    if (group.scattering != 0)
        draw_samples16(step, plain ? AT_LIGHT : AT_LIGHT + 1, LOBES ? 4 : 3, true, &group);
    for (uint left = group.scattering; left != 0; left &= left - 1) {
        const uint k = lowest_bit(left);
        const float3 outgoing = -(float3)(group.ray[k].dx, group.ray[k].dy, group.ray[k].dz);
        prepare_shading(frame, SCENE, &group.samples[k], outgoing, &group.at[k], &group.lobe[k]);
    }
#if LISTED_LIGHTS
    if (lights.data.grid_probability > 0.0f) pick_lights16(&lights, &group, shaded);
#endif
    for (uint k = 0; k < count; ++k) {
        if (group.scattering & 1u << k)
            shade_surface_at(step, depth, SCENE, &lights, group.ray[k], group.state[k], &group.samples[k], group.lobe[k],
                             group.picked & 1u << k ? &group.listed[k] : 0, &group.at[k], shading_normals, &gathered[k], &shaded[k].next,
                             group.plain & 1u << k ? 0 : &shaded[k].shadow);
#if MIPMAPS
        const RayCone cone = cone_of_ray(frame, depth, queue, room, rays[k]);
        if (shaded[k].next.wanted) shaded[k].next.cone = scattered_cone(cone, hits[rays[k]].t, shaded[k].next.state.pdf);
#endif
        add_gathered(gathered[k], group.state[k].path, radiance);
        note_next(step, group.state[k].path, &shaded[k].next, radiance);
    }
}
#else
/// Shades ray i of the queue and adds the light that it gathers to its path.
static inline void shade_ray(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, uint i,
                             global float* radiance, ShadedRay* shaded) {
    const uint depth = step->depth, room = step->room;
    const PathState state = queued_state(&states_of_queue(queue, room)[i]);
    const RayCone cone = cone_of_ray(&step->frame, depth, queue, room, i);
    shaded->time = time_in_queue(queue, room, i);
    float3 gathered;
#if PATH_GUIDE
    if (teaches(&step->frame, depth)) note_light_before(step, state.path, radiance);
#endif
    shade_hit(step, depth, SCENE, queued_ray(&rays_of_queue(queue)[i]), hits[i], shaded->time, state, cone,
              media_of_ray(depth, queue, room, i), radiance + 3 * (size_t)room, &gathered, &shaded->next, &shaded->shadow);
    add_gathered(gathered, state.path, radiance);
    note_next(step, state.path, &shaded->next, radiance);
}
#endif

/// Shades the `count` rays of the queue with the numbers `rays`.
static inline void shade_rays(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, const uint* rays,
                              uint count, global float* radiance, ShadedRay* shaded) {
#if SHADE_GROUPS
    shade_rays16(step, SCENE, queue, hits, rays, count, radiance, shaded);
#else
    for (uint k = 0; k < count; ++k) shade_ray(step, SCENE, queue, hits, rays[k], radiance, &shaded[k]);
#endif
}

#if CLARAY_CPU
/// The numbers of the rays that are shaded `begin`-th and next. Camera rays with one sample per pixel are shaded in squares of 4x4 pixels,
/// which share more cells of lights and triangles than rows, and squares in strips, so that rays that follow each other in the next
/// queues begin close together.
static inline void number_rays16(const Step* step, uint begin, uint all, uint* rays) {
    const Batch* batch = &step->batch;
    const uint width = max(step->frame.width, 1u), strip = STRIP_ROWS * width, first = begin - begin % strip;
    const uint rows = min((all - first) / width, (uint)STRIP_ROWS) & ~3u;
    const bool square = step->depth == 0 && batch->samples == 1 && !batch->listed && width % 4 == 0 && begin - first < rows * width;
    const uint number = square ? (begin - first) / 16 : 0, column = square ? number / (rows / 4) : 0;
    const uint corner = first + 4 * ((number - column * (rows / 4)) * width + column);
    for (uint k = 0; k < 16; ++k) rays[k] = square ? corner + k / 4 * width + k % 4 : begin + k;
}
#endif

static inline void store_next(const ShadedRay* shaded, global RayQueue* queue, uint room, uint slot) {
    store_ray(&rays_of_queue(queue)[slot], shaded->next.ray);
    store_state(&states_of_queue(queue, room)[slot], shaded->next.state);
#if INSTANCE_MOTION
    times_of_queue(queue, room)[slot] = shaded->time;
#endif
#if MIPMAPS
    cones_of_queue(queue, room)[slot] = shaded->next.cone;
#endif
#if NESTED_MEDIA
    media_of_queue(queue, room)[slot] = shaded->next.media;
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

#if CLARAY_CPU
/// Where the stage appends rays.
typedef struct NextQueues {
    global uint *next_length, *shadow_length;
    global RayQueue* next;
    global ShadowQueue* shadow;
} NextQueues;

#if SHADE_SIXTEEN || SHADE_MIXED
/// Shades rays that met plain materials or nothing, at most 16.
static CLARAY_OUTLINED void shade_plain(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, const uint* numbers,
                               uint count, const NextQueues* to, global float* radiance) {
    const uint room = step->room;
    Shaded16 shaded;
    const uint16 bins = shade_sixteen(step, SCENE, rays_of_queue(queue), hits, states_of_queue(queue, room), numbers, count, radiance,
                                      radiance + 3 * (size_t)room, &shaded);
#if PATH_GUIDE
    if (teaches(&step->frame, step->depth)) note_bins16(step, &shaded, count, bins, radiance);
#else
    (void)bins;
#endif
    store_next16(&step->frame, &shaded, to->next_length, rays_of_queue(to->next), states_of_queue(to->next, room));
    store_shadows16(&shaded, to->shadow_length, rays_of_shadows(to->shadow), light_of_shadows(to->shadow, room));
}
#endif

#if !SHADE_SIXTEEN
/// Shades any rays, at most 16.
static inline void shade_any(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, const uint* numbers,
                             uint count, const NextQueues* to, global float* radiance) {
    ShadedRay shaded[SLOTS_AT_ONCE];
    uint rays = 0, shadows = 0;
    shade_rays(step, SCENE, queue, hits, numbers, count, radiance, shaded);
    for (uint k = 0; k < count; ++k) rays += shaded[k].next.wanted, shadows += shaded[k].shadow.wanted;
    uint slot = rays ? atomic_add(to->next_length, rays) : 0u;
    for (uint k = 0; k < count; ++k)
        if (shaded[k].next.wanted) store_next(&shaded[k], to->next, step->room, slot++);
#if LIGHTS
    slot = shadows ? atomic_add(to->shadow_length, shadows) : 0u;
    for (uint k = 0; k < count; ++k)
        if (shaded[k].shadow.wanted) store_shadow(&shaded[k], to->shadow, step->room, slot++);
#endif
}
#endif

#if SHADE_MIXED
/// Rays that wait for others of their kind.
typedef struct WaitingRays {
    uint count;
    uint numbers[2 * SLOTS_AT_ONCE];
} WaitingRays;

/// Takes 16 rays out, or those that there are. Returns their number.
static inline uint take_rays16(WaitingRays* from, uint* numbers) {
    const uint count = min(from->count, SLOTS_AT_ONCE);
    for (uint k = 0; k < SLOTS_AT_ONCE; ++k) numbers[k] = from->numbers[k], from->numbers[k] = from->numbers[k + SLOTS_AT_ONCE];
    from->count -= count;
    return count;
}

static inline bool meets_plain(const FrameData* frame, SCENE_PARAMETERS, Hit hit) {
    if (hit.primitive == CLARAY_MISS) return true;
    global const MaterialData* material = plain_material_at(frame, tables, hit);
    return material->kind == CLARAY_LAMBERT && material->layers == 0u;
}

/// Shades rays `begin` to `end` - 1: those of plain materials together, and the others.
static inline void shade_sorted(const Step* step, SCENE_PARAMETERS, global RayQueue* queue, global const SceneHit* hits, uint begin,
                                uint end, uint all, const NextQueues* to, global float* radiance) {
    WaitingRays plain, other;
    plain.count = other.count = 0;
    uint numbers[SLOTS_AT_ONCE];
    for (uint i = begin; i < end; i += SLOTS_AT_ONCE) {
        const bool is_last = i + SLOTS_AT_ONCE >= end;
        number_rays16(step, i, all, numbers);
        for (uint k = 0; k < min(SLOTS_AT_ONCE, end - i); ++k) {
            WaitingRays* of = meets_plain(&step->frame, SCENE, hits[numbers[k]]) ? &plain : &other;
            of->numbers[of->count++] = numbers[k];
        }
        while (plain.count >= SLOTS_AT_ONCE || (is_last && plain.count != 0)) {
            const uint count = take_rays16(&plain, numbers);
            shade_plain(step, SCENE, queue, hits, numbers, count, to, radiance);
        }
        while (other.count >= SLOTS_AT_ONCE || (is_last && other.count != 0)) {
            const uint count = take_rays16(&other, numbers);
            shade_any(step, SCENE, queue, hits, numbers, count, to, radiance);
        }
    }
}
#endif
#endif

/// Shades the rays of `queue`, which met `depth` surfaces before this one. Fills the next queue and, under LIGHTS, the queue of
/// shadow rays; the lengths of both are 0 before. Adds the lengths of the previous bounce's queues to `totals` and sets them to 0,
/// so that these queues can be filled next. With a light tree, the paths' shading normals follow `radiance` in the same buffer.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void shade_surface(Step step, SCENE_PARAMETERS, global QueueLength* lengths, global ulong* totals,
                   global RayQueue* queue, global const SceneHit* hits, global RayQueue* next_queue,
                   global ShadowQueue* shadow_queue, global float* radiance) {
    const uint depth = step.depth;
    if (get_global_id(0) == 0)
        count_spent(length_of_rays(lengths, depth + 2), length_of_shadows(lengths, depth + 1), totals);
    const uint all = min(*length_of_rays(lengths, depth), step.capacity);
    global uint* next_length = length_of_rays(lengths, depth + 1);
    global uint* shadow_length = length_of_shadows(lengths, depth);
#if CLARAY_CPU
    const NextQueues to = {next_length, shadow_length, next_queue, shadow_queue};
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
#if SHADE_MIXED
    shade_sorted(&step, SCENE, queue, hits, begin, end, all, &to, radiance);
#else
    for (uint i = begin; i < end; i += 16u) {
        uint numbers[16];
#if SHADE_SIXTEEN
        for (uint k = 0; k < 16u; ++k) numbers[k] = i + k;
        shade_plain(&step, SCENE, queue, hits, numbers, min(16u, end - i), &to, radiance);
#else
        number_rays16(&step, i, all, numbers);
        shade_any(&step, SCENE, queue, hits, numbers, min(SLOTS_AT_ONCE, end - i), &to, radiance);
#endif
    }
#endif
#else
    local uint scratch[2];
    ShadedRay shaded;
    shaded.next.wanted = shaded.shadow.wanted = false;
    const uint number = get_global_id(0);
    if (number < all) shade_rays(&step, SCENE, queue, hits, &number, 1u, radiance, &shaded);
    const uint slot = reserve_slot(next_length, shaded.next.wanted, scratch);
    if (shaded.next.wanted) store_next(&shaded, next_queue, step.room, slot);
#if LIGHTS
    const uint shadow_slot = reserve_slot(shadow_length, shaded.shadow.wanted, scratch);
    if (shaded.shadow.wanted) store_shadow(&shaded, shadow_queue, step.room, shadow_slot);
#endif
#endif
}
