// Guides of the denoiser: what the camera rays of a pixel see, directly or through mirrors and smooth glass. The rays are those of
// the film's samples, so that the mean of what they see has the same noise as the film; further rays of the same sequence give a
// mean with less.
#include "claray/shared/denoise.h"
#include "render/first_ray.clh"
#include "render/queue.clh"
#include "render/shade_hit.clh"

#define LEAST_ALBEDO 0.02f  // darker surfaces count as this, so that light that their coats reflect is finite per albedo
#ifndef MOST_MIRRORS
#define MOST_MIRRORS 6u  // a glass ball seen in another one
#endif

/// The pixel of element i of a batch: consecutive pixels, or consecutive elements of a list.
static inline uint guided_pixel(const GuideStep* guide, uint i, global const uint* list) {
    const uint element = guide->step.batch.first_pixel + i;
    return guide->listed ? list[element] : element;
}

/// The sample of a camera ray, as a batch of its own.
static inline Batch sample_of(const GuideStep* guide, uint ray, global const uint* list) {
    const uint samples = guide->step.batch.samples;
    const Batch one = {guided_pixel(guide, ray / samples, list), 1u, ray % samples, 1u};
    return one;
}

/// Camera rays: `samples` of each pixel, from the first sample on.
kernel void guide_rays(GuideStep guide, global const uint* list, global Ray* rays, global float* times) {
    const uint i = get_global_id(0);
    if (i >= guide.step.capacity) return;
    float time = 0.0f;
    store_ray(&rays[i], first_ray(sample_of(&guide, i, list), &guide.step.frame, 0, 0u, &time));
#if INSTANCE_MOTION
    times[i] = time;
#endif
}

static inline float3 albedo_there(const ShadingPoint* at) { return fmax(albedo_of(&at->material), LEAST_ALBEDO); }

/// The next ray, if the surface is a mirror or smooth glass; the path of the film's sample takes the same.
static inline NextRay pass_mirror(Batch one, const FrameData* frame, SCENE_PARAMETERS, uint depth, Ray ray, PathState state,
                                  ShadingPoint* at) {
    NextRay next;
    next.wanted = false;
    const SurfaceSamples samples = samples_at(samples_of(one, 0, 0u, frame->seed), depth);
    float lobe;
    prepare_shading(frame, SCENE, &samples, -(float3)(ray.dx, ray.dy, ray.dz), at, &lobe);
    if (!is_delta(&at->material)) return next;
    return scatter(false, 0, &samples, depth, state, at, unit_float(words_at(&samples, AT_CHOICE).x), lobe);
}

/// As shade_hit, without the light that rough surfaces reflect. Adds to `sight`; `next` is wanted if the ray goes on.
static inline void see(Batch one, const FrameData* frame, SCENE_PARAMETERS, uint depth, Ray ray, SceneHit found, float time,
                       Sight* sight, NextRay* next) {
    const Lights lights = lights_of(frame, SCENE);
    const float3 direction = (float3)(ray.dx, ray.dy, ray.dz), outgoing = -direction;
    PathState state = {sight->throughput_r, sight->throughput_g, sight->throughput_b, 0.0f, 0u};
    next->wanted = false;
#if INSTANCES
    const Hit hit = hit_in_scene(found, instances);
#else
    const Hit hit = found;
#endif
    float3 glow, albedo = (float3)(0.0f);
    if (hit.primitive == CLARAY_MISS) {
        glow = radiance_beyond(&lights, frame->sky, direction, state);
    } else {
        ShadingPoint at;
        find_surface(frame, SCENE, found, hit, depth, time, outgoing, &at);
#if TEXTURES
        MapValues maps = {false, (float3)(0.0f)};
        const RayCone cone = camera_cone(frame);
        if (textures)
            maps = apply_maps(textures, TABLE(uint, triangle_materials)[hit.primitive], indices, hit, outgoing,
                              cone.width + cone.spread * hit.t, &at.surface, &at.material);
#endif
#if ABSORPTION
        if (at.surface.inside) state = attenuated(state, transmittance_of(&at.material, hit.t));
#endif
        if (depth == 0u) {
            sight->normal_x = at.surface.shading.x, sight->normal_y = at.surface.shading.y, sight->normal_z = at.surface.shading.z;
            sight->nearness = 1.0f / fmax(hit.t, 1e-30f);
        }
        albedo = throughput_of(state) * albedo_there(&at);
        bool ends = depth + 1u >= min(MOST_MIRRORS, frame->max_depth);
        glow = emitted_radiance(&lights, SCENE, found, hit, 0u, ray, state, &at, 0);
#if USES(CLARAY_UNLIT)
        if (at.material.kind == CLARAY_UNLIT) glow = throughput_of(state) * albedo_of(&at.material), ends = true;
#endif
#if TEXTURES && LIGHT_MAPS
        if (maps.has_light && !at.surface.inside) glow += albedo * maps.light * INV_PI, ends = true;
#endif
        if (!ends) *next = pass_mirror(one, frame, SCENE, depth, ray, state, &at);
    }
    sight->glow_r += glow.x, sight->glow_g += glow.y, sight->glow_b += glow.z;
    sight->albedo_r = albedo.x, sight->albedo_g = albedo.y, sight->albedo_b = albedo.z;
    sight->throughput_r = next->state.throughput_r, sight->throughput_g = next->state.throughput_g;
    sight->throughput_b = next->state.throughput_b;
}

/// `numbers`: the number of rays, and from depth 1 on the index of each among the camera rays. Rays that go on are appended to the
/// `next` ones, whose number is 0 before.
kernel void see_surfaces(GuideStep guide, global const uint* list, SCENE_PARAMETERS, global const Ray* rays,
                         global const SceneHit* hits, global const uint* numbers, global Sight* sights, global Ray* next_rays, global float* next_times, global uint* next_numbers) {
    const uint i = get_global_id(0), depth = guide.step.depth;
    if (i >= guide.step.capacity) return;
    const uint ray = depth == 0u ? i : numbers[1 + i];
    Sight sight = {1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
    if (depth != 0u) sight = sights[ray];
    const Batch one = sample_of(&guide, ray, list);
    float time = 0.0f;
#if INSTANCE_MOTION
    time = time_of(samples_of(one, 0, 0u, guide.step.frame.seed));
#endif
    NextRay next;
    see(one, &guide.step.frame, SCENE, depth, queued_ray(&rays[i]), hits[i], time, &sight, &next);
    sights[ray] = sight;
    if (!next.wanted) return;
    const uint slot = atomic_inc(next_numbers);
    store_ray(&next_rays[slot], next.ray);
    next_numbers[1 + slot] = ray;
#if INSTANCE_MOTION
    next_times[slot] = time;
#endif
}

/// One pixel per item. If the film has more samples than were traced here, both means are over all that were.
kernel void write_guides(GuideStep step, global const uint* list, global const FilmPixel* film, global const Sight* sights,
                         global Guide* guides) {
    const uint i = get_global_id(0);
    const Batch batch = step.step.batch;
    if (i >= batch.pixels) return;
    const uint pixel = guided_pixel(&step, i, list);
    const uint in_film = film[pixel].count + film[pixel].dropped;
    const uint sampled = in_film == 0u || in_film > batch.samples ? batch.samples : in_film;
    float3 albedo = (float3)(0.0f), glow = (float3)(0.0f), normal = (float3)(0.0f);
    float nearness = 0.0f;
    Guide guide;
    for (uint s = 0; s < batch.samples; ++s) {
        const Sight sight = sights[i * batch.samples + s];
        albedo += (float3)(sight.albedo_r, sight.albedo_g, sight.albedo_b);
        glow += (float3)(sight.glow_r, sight.glow_g, sight.glow_b);
        normal += (float3)(sight.normal_x, sight.normal_y, sight.normal_z);
        nearness += sight.nearness;
        if (s + 1 != sampled) continue;
        const float share = 1.0f / (float)sampled;
        guide.sampled_albedo_r = share * albedo.x, guide.sampled_albedo_g = share * albedo.y, guide.sampled_albedo_b = share * albedo.z;
        guide.sampled_glow_r = share * glow.x, guide.sampled_glow_g = share * glow.y, guide.sampled_glow_b = share * glow.z;
    }
    const float share = 1.0f / (float)batch.samples;
    guide.albedo_r = share * albedo.x, guide.albedo_g = share * albedo.y, guide.albedo_b = share * albedo.z;
    guide.glow_r = share * glow.x, guide.glow_g = share * glow.y, guide.glow_b = share * glow.z;
    guide.normal_x = share * normal.x, guide.normal_y = share * normal.y, guide.normal_z = share * normal.z;
    guide.nearness = share * nearness;
    guides[pixel] = guide;
}

/// Lists the pixels whose glow differs from a neighbour's: borders of lamps and of the sky, where the film's noise is that of
/// coverage. The order of the list does not matter. `edges`, their number, is 0 before.
kernel void list_edges(uint width, uint height, global const Guide* guides, global uint* list, global uint* edges) {
    const uint i = get_global_id(0);
    if (i >= width * height) return;
    const int x = (int)(i % width), y = (int)(i / width);
    float least = INFINITY, most = 0.0f;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int at = clamp(y + dy, 0, (int)height - 1) * (int)width + clamp(x + dx, 0, (int)width - 1);
            const float glow = guides[at].glow_r + guides[at].glow_g + guides[at].glow_b;
            least = fmin(least, glow), most = fmax(most, glow);
        }
    if (most - least > 0.125f * most) list[atomic_inc(edges)] = i;  // a slow gradient, as in the sky, is no edge
}
