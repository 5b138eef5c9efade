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
#ifndef GLOSSY_DENSITY
#define GLOSSY_DENSITY 1.0f  // per steradian: directions sampled with more than this come from an almost mirror
#endif

/// The pixel of element i of a batch: consecutive pixels, or consecutive elements of a list.
static inline uint guided_pixel(const GuideStep* guide, uint i, global const uint* list) {
    const uint element = guide->step.batch.first_pixel + i;
    return guide->listed ? list[element] : element;
}

/// The sample of a camera ray, as a batch of its own.
static inline Batch sample_of(const GuideStep* guide, uint ray, global const uint* list) {
    const uint samples = guide->step.batch.samples;
    const Batch one = {guided_pixel(guide, ray / samples, list), 1u, ray % samples, 1u, 0u};
    return one;
}

#if CLARAY_CPU
/// Camera rays: `samples` of each pixel, from the first sample on. Sixteen per work-item, as in generate_rays.cl.
kernel void guide_rays(GuideStep guide, global const uint* list, global Ray* rays, global float* times) {
    const uint begin = 16u * (uint)get_global_id(0), count = guide.step.capacity, of_each = guide.step.batch.samples;
    if (begin >= count) return;
    uint pixel[16];
    const uint16 lanes = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const uint16 rays_here = min(begin + lanes, (uint16)(count - 1)), elements = quotients16(rays_here, of_each);
    vstore16(elements, 0, pixel);
    for (uint i = 0; i < 16; ++i) pixel[i] = guided_pixel(&guide, pixel[i], list);
    const uint16 pixels = vload16(0, pixel), seeds = hash_words_of_16(pixels, (uint16)(guide.step.frame.seed));
    store_first_rays16(&guide.step.frame, pixels, seeds, rays_here - elements * of_each, 0u, min(16u, count - begin), rays + begin, times + begin);
}
#else
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
#endif

static inline float3 albedo_there(const ShadingPoint* at) { return fmax(albedo_of(&at->material), LEAST_ALBEDO); }

/// The next ray, if the surface is a mirror, smooth glass or almost a mirror; the path of the film's sample takes the same, unless it
/// goes to a hot spot.
static inline NextRay pass_mirror(Batch one, const FrameData* frame, SCENE_PARAMETERS, uint depth, Ray ray, PathState state,
                                  ShadingPoint* at) {
    NextRay next;
    next.wanted = false;
    if (CLARAY_IS_DIFFUSE(at->material.kind) && at->material.layers == 0u) return next;
    const SurfaceSamples samples = samples_at(samples_of(one, 0, 0u, frame->seed), depth);
    float lobe;
    prepare_shading(frame, SCENE, &samples, -(float3)(ray.dx, ray.dy, ray.dz), at, &lobe);
    const bool delta = is_delta(&at->material);
    next = scatter(frame, false, 0, &samples, depth, state, at, unit_float(words_at(&samples, AT_CHOICE).x), lobe);
    next.wanted = next.wanted && (delta || next.state.pdf > GLOSSY_DENSITY);
    return next;
}

/// As shade_hit, without the light that rough surfaces reflect. Adds to `sight`; `next` is wanted if the ray goes on.
static inline void see(Batch one, const FrameData* frame, SCENE_PARAMETERS, uint depth, Ray ray, SceneHit found, float time,
                       Sight* sight, NextRay* next) {
    const Lights lights = lights_of(frame, SCENE);
    const float3 direction = (float3)(ray.dx, ray.dy, ray.dz), outgoing = -direction;
    PathState state = {sight->throughput_r, sight->throughput_g, sight->throughput_b, sight->pdf, 0u};
    next->wanted = false;
#if INSTANCES
    const Hit hit = hit_in_scene(found, instances);
#else
    const Hit hit = found;
#endif
    float3 glow, albedo = (float3)(0.0f);
    if (hit.primitive == CLARAY_MISS) {
        glow = radiance_beyond(frame, &lights, direction, state);
    } else {
        ShadingPoint at;
        find_surface(0, frame, SCENE, found, hit, depth, time, ray, &at);
#if TEXTURES
        MapValues maps = {false, (float3)(0.0f)};
        const RayCone cone = camera_cone(frame);
        if (textures && !IS_PRIMITIVE(hit))
            maps = apply_maps(0, textures, TABLE(uint, triangle_materials)[hit.primitive], indices, hit, outgoing,
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
        if (at.material.kind == CLARAY_UNLIT) glow = state.pdf == 0.0f ? throughput_of(state) * albedo_of(&at.material) : (float3)(0.0f), ends = true;
#endif
#if TEXTURES && LIGHT_MAPS
        if (maps.has_light && !at.surface.inside) glow += albedo * maps.light * INV_PI, ends = true;
#endif
        if (!ends) *next = pass_mirror(one, frame, SCENE, depth, ray, state, &at);
    }
    if (sight->passed == CLARAY_BY_GLOSS) {
        sight->gloss_r += glow.x, sight->gloss_g += glow.y, sight->gloss_b += glow.z;
    } else {
        sight->glow_r += glow.x, sight->glow_g += glow.y, sight->glow_b += glow.z;
        sight->albedo_r = albedo.x, sight->albedo_g = albedo.y, sight->albedo_b = albedo.z;
    }
    if (!next->wanted) return;
    sight->pdf = next->state.pdf;
    sight->passed = max(sight->passed, next->state.pdf > 0.0f ? CLARAY_BY_GLOSS : CLARAY_BY_MIRROR);
    sight->throughput_r = next->state.throughput_r, sight->throughput_g = next->state.throughput_g;
    sight->throughput_b = next->state.throughput_b;
}

/// `numbers`: the number of rays, and from depth 1 on the index of each among the camera rays. Rays that go on are appended to the
/// `next` ones, whose number is 0 before.
kernel void see_surfaces(GuideStep guide, global const uint* list, SCENE_PARAMETERS, global const Ray* rays,
                         global const SceneHit* hits, global const uint* numbers, global Sight* sights, global Ray* next_rays, global float* next_times, global uint* next_numbers) {
    const uint i = get_global_id(0), depth = guide.step.depth;
    if (i >= guide.step.capacity || i >= numbers[0]) return;
    const uint ray = depth == 0u ? i : numbers[1 + i];
    Sight sight = {1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0u};
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

/// From sums of n values and of their squares. One value tells no variance: there it is the square.
static inline float3 variances_of_means(float3 sums, float3 squares, uint n) {
    const float3 means = sums / (float)n;
    return n < 2 ? means * means : fmax(squares / (float)n - means * means, 0.0f) / (float)(n - 1);
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
    float3 albedo = (float3)(0.0f), glow = (float3)(0.0f), gloss = (float3)(0.0f), normal = (float3)(0.0f);
    float nearness = 0.0f, odd = 0.0f, mirrored = 0.0f;
    float3 sums = (float3)(0.0f), squares = (float3)(0.0f);  // of the luminances of albedo, glow and gloss
    Guide guide;
    for (uint s = 0; s < batch.samples; ++s) {
        const Sight sight = sights[i * batch.samples + s];
        const float3 one_albedo = (float3)(sight.albedo_r, sight.albedo_g, sight.albedo_b);
        const float3 one_glow = (float3)(sight.glow_r, sight.glow_g, sight.glow_b);
        const float3 one_gloss = (float3)(sight.gloss_r, sight.gloss_g, sight.gloss_b);
        albedo += one_albedo, glow += one_glow, gloss += one_gloss;
        const float3 bright = (float3)(luminance(one_albedo), luminance(one_glow), luminance(one_gloss));
        sums += bright, squares += bright * bright;
        if (s < sampled && s % 2 != 0) odd += bright.y + bright.z;
        normal += (float3)(sight.normal_x, sight.normal_y, sight.normal_z);
        nearness += sight.nearness, mirrored += sight.passed ? 1.0f : 0.0f;
        if (s + 1 != sampled) continue;
        const float share = 1.0f / (float)sampled;
        guide.sampled_albedo_r = share * albedo.x, guide.sampled_albedo_g = share * albedo.y, guide.sampled_albedo_b = share * albedo.z;
        const float3 all = glow + gloss;
        guide.sampled_glow_r = share * all.x, guide.sampled_glow_g = share * all.y, guide.sampled_glow_b = share * all.z;
        const float odds = (float)(sampled / 2);
        guide.glow_difference = sampled < 2 || sampled != in_film ? 0.0f : (luminance(all) - odd) / ((float)sampled - odds) - odd / odds;
    }
    const float share = 1.0f / (float)batch.samples;
    guide.albedo_r = share * albedo.x, guide.albedo_g = share * albedo.y, guide.albedo_b = share * albedo.z;
    guide.glow_r = share * glow.x, guide.glow_g = share * glow.y, guide.glow_b = share * glow.z;
    guide.gloss_r = share * gloss.x, guide.gloss_g = share * gloss.y, guide.gloss_b = share * gloss.z;
    const bool all_traced = in_film <= batch.samples;
    const float3 variances = variances_of_means(sums, squares, batch.samples);
    guide.albedo_variance = all_traced ? 0.0f : variances.x, guide.glow_variance = all_traced ? 0.0f : variances.y;
    guide.gloss_variance = all_traced ? variances.z : 0.0f;
    guide.normal_x = share * normal.x, guide.normal_y = share * normal.y, guide.normal_z = share * normal.z;
    guide.nearness = share * nearness, guide.mirrored = share * mirrored;
    guides[pixel] = guide;
}

/// Sorts the pixels whose glow differs from a neighbour's into classes by the difference, a factor of 4 each: borders of lamps and of
/// the sky, where the film's noise is that of coverage, and highlights. `counts`, of the pixels in each class, are 0 before.
kernel void find_edges(uint width, uint height, global const Guide* guides, global uchar* classes, global uint* counts) {
    const uint i = get_global_id(0);
    if (i >= width * height) return;
    const int x = (int)(i % width), y = (int)(i / width);
    float least = INFINITY, most = 0.0f;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int at = clamp(y + dy, 0, (int)height - 1) * (int)width + clamp(x + dx, 0, (int)width - 1);
            const Guide g = guides[at];
            const float glow = g.glow_r + g.glow_g + g.glow_b + g.gloss_r + g.gloss_g + g.gloss_b;
            least = fmin(least, glow), most = fmax(most, glow);
        }
    const float difference = most - least;
    const bool is_edge = difference > 0.125f * most;  // a slow gradient, as in the sky, is none
    const int exponent = (int)(as_uint(difference) >> 23) - 127;
    const uchar class = is_edge ? (uchar)clamp(exponent / 2 + (int)CLARAY_EDGE_CLASSES / 2, 0, (int)CLARAY_EDGE_CLASSES - 1) : (uchar)CLARAY_EDGE_CLASSES;
    classes[i] = class;
    if (is_edge) atomic_inc(&counts[class]);
}

/// Lists the edges by class, in any order. `ends`: where the next pixel of each class goes.
kernel void list_edges(uint pixels, global const uchar* classes, global uint* list, global uint* ends) {
    const uint i = get_global_id(0);
    if (i < pixels && classes[i] < CLARAY_EDGE_CLASSES) list[atomic_inc(&ends[classes[i]])] = i;
}
