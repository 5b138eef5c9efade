// Guides of the denoiser: what the camera rays of a pixel meet first. The rays are those of the film's samples, so that the mean
// of what they meet has the same noise as the film; further rays of the same sequence give a mean with less.
#include "claray/shared/denoise.h"
#include "render/first_ray.clh"
#include "render/queue.clh"
#include "render/shade_hit.clh"

/// The pixel of element i of a batch: consecutive pixels, or consecutive elements of a list.
static inline uint guided_pixel(Batch batch, uint i, uint listed, global const uint* list) {
    return listed ? list[batch.first_pixel + i] : batch.first_pixel + i;
}

/// Camera rays: `batch.samples` of each pixel, from the first sample on.
kernel void guide_rays(Batch batch, FrameData frame, uint listed, global const uint* list, global Ray* rays, global float* times) {
    const uint i = get_global_id(0);
    if (i >= batch.pixels * batch.samples) return;
    const Batch one = {guided_pixel(batch, i / batch.samples, listed, list), 1u, i % batch.samples, 1u};
    float time = 0.0f;
    store_ray(&rays[i], first_ray(one, frame, 0u, false, &time));
#if INSTANCE_MOTION
    times[i] = time;
#endif
}

#define LEAST_ALBEDO 0.02f  // darker surfaces count as this, so that light that their coats reflect is finite per albedo

/// The first surface of a ray. Beyond all surfaces the albedo is 0, so that light per albedo is that of the covered part of a pixel.
typedef struct FirstSurface {
    float3 albedo, glow, normal;
    float nearness;
} FirstSurface;

static inline void add_surface(FirstSurface* sum, FirstSurface one) {
    sum->albedo += one.albedo;
    sum->glow += one.glow;
    sum->normal += one.normal;
    sum->nearness += one.nearness;
}

/// As shade_hit at depth 0, without reflected light.
static inline FirstSurface first_surface(const FrameData* frame, SCENE_PARAMETERS, const Lights* lights, Ray ray, SceneHit found,
                                         float time) {
    FirstSurface first = {(float3)(0.0f), (float3)(0.0f), (float3)(0.0f), 0.0f};
    const float3 direction = (float3)(ray.dx, ray.dy, ray.dz), outgoing = -direction;
    const PathState state = first_state(0u);
#if INSTANCES
    const Hit hit = hit_in_scene(found, instances);
#else
    const Hit hit = found;
#endif
    if (hit.primitive == CLARAY_MISS) {
        first.glow = radiance_beyond(lights, frame->sky, direction, state);
        return first;
    }
    ShadingPoint at;
    find_surface(frame, SCENE, found, hit, 0u, time, outgoing, &at);
#if TEXTURES
    MapValues maps = {false, (float3)(0.0f)};
    const RayCone cone = camera_cone(frame);
    if (textures)
        maps = apply_maps(textures, TABLE(uint, triangle_materials)[hit.primitive], indices, hit, outgoing,
                          cone.width + cone.spread * hit.t, &at.surface, &at.material);
#endif
    first.albedo = fmax(albedo_of(&at.material), LEAST_ALBEDO);
    first.normal = at.surface.shading;
    first.nearness = 1.0f / fmax(hit.t, 1e-30f);
#if USES(CLARAY_UNLIT)
    if (at.material.kind == CLARAY_UNLIT) {
        first.glow = first.albedo;
        return first;
    }
#endif
    first.glow = emitted_radiance(lights, SCENE, found, hit, 0u, ray, state, &at, 0);
#if TEXTURES && LIGHT_MAPS
    if (maps.has_light && !at.surface.inside) first.glow += first.albedo * maps.light * INV_PI;
#endif
    return first;
}

/// One pixel per item. If the film has more samples than `batch.samples`, both means are over all rays of the batch.
kernel void write_guides(Batch batch, FrameData frame, uint listed, global const uint* list, global const FilmPixel* film,
                         SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits, global const float* times,
                         global Guide* guides) {
    const uint i = get_global_id(0);
    if (i >= batch.pixels) return;
    const uint pixel = guided_pixel(batch, i, listed, list);
    const uint in_film = film[pixel].count + film[pixel].dropped;
    const uint sampled = in_film == 0u || in_film > batch.samples ? batch.samples : in_film;
    const Lights lights = lights_of(&frame, SCENE);
    FirstSurface sum = {(float3)(0.0f), (float3)(0.0f), (float3)(0.0f), 0.0f};
    Guide guide;
    for (uint s = 0; s < batch.samples; ++s) {
        const uint ray = i * batch.samples + s;
        float time = 0.0f;
#if INSTANCE_MOTION
        time = times[ray];
#endif
        add_surface(&sum, first_surface(&frame, SCENE, &lights, queued_ray(&rays[ray]), hits[ray], time));
        if (s + 1 != sampled) continue;
        const float3 albedo = sum.albedo / (float)sampled, glow = sum.glow / (float)sampled;
        guide.sampled_albedo_r = albedo.x, guide.sampled_albedo_g = albedo.y, guide.sampled_albedo_b = albedo.z;
        guide.sampled_glow_r = glow.x, guide.sampled_glow_g = glow.y, guide.sampled_glow_b = glow.z;
    }
    const float share = 1.0f / (float)batch.samples;
    guide.albedo_r = share * sum.albedo.x, guide.albedo_g = share * sum.albedo.y, guide.albedo_b = share * sum.albedo.z;
    guide.glow_r = share * sum.glow.x, guide.glow_g = share * sum.glow.y, guide.glow_b = share * sum.glow.z;
    guide.normal_x = share * sum.normal.x, guide.normal_y = share * sum.normal.y, guide.normal_z = share * sum.normal.z;
    guide.nearness = share * sum.nearness;
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
