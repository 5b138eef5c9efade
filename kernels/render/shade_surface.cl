// The stage between two traces: a path gathers what the surface or the sky emits, asks for light by a shadow ray, and goes
// on in a direction chosen by the material. Light from emissive triangles and from an environment is found in both ways,
// weighted by multiple importance sampling (Veach 1997, chapter 9).
#include "claray/shared/types.h"
#include "render/queue.clh"
#include "render/samples.clh"
#include "shade/bsdf.clh"
#include "shade/light.clh"
#include "shade/maps.clh"
#include "shade/surface.clh"

#ifndef BAKE
#define BAKE 0  // 1: paths begin at surfaces, which count as white Lambertians that emit nothing
#endif
#ifndef PATHS_PER_ITEM
#define PATHS_PER_ITEM 64  // consecutive rays that an item shades, on CPUs; on GPUs 1
#endif
#ifndef SIXTEEN
#define SIXTEEN 1  // 1: sixteen rays at once where that can be
#endif
#ifndef ROULETTE_DEPTH
#define ROULETTE_DEPTH 3  // surfaces that a path meets before chance may end it
#endif
#ifndef CAUSTICS
#define CAUSTICS 1  // for studies; 0: paths that a rough surface has scattered end at mirrors and smooth glass
#endif

#define SCENE_PARAMETERS                                                                                       \
    global const float *positions, global const uint *indices, global const float *normals,                    \
        global const uint *triangle_materials, global const MaterialData *materials,                           \
        global const float *energy_tables, LIGHT_PARAMETERS, global const uint *textures INSTANCE_PARAMETERS
#define SCENE                                                                                                  \
    positions, indices, normals, triangle_materials, materials, energy_tables, LIGHT_BUFFERS, textures INSTANCE_BUFFERS
#if INSTANCE_MOTION
#define TIME_PARAMETERS , global const float *times, global float *next_times, global float *shadow_times
#else
#define TIME_PARAMETERS
#endif

/// A ray to be traced, with what goes along with it.
typedef struct NextRay {
    bool wanted;
    Ray ray;
    PathState state;
    RayCone cone;  // under MIPMAPS
} NextRay;
typedef struct NextShadow {
    bool wanted;
    Ray ray;
    LightSample light;
} NextShadow;

static inline float3 throughput_of(PathState state) {
    return (float3)(state.throughput_r, state.throughput_g, state.throughput_b);
}

static inline PathState attenuated(PathState state, float3 transmittance) {
    state.throughput_r *= transmittance.x, state.throughput_g *= transmittance.y, state.throughput_b *= transmittance.z;
    return state;
}

static inline Ray make_ray(float3 origin, float3 direction, float tmax) {
    const Ray ray = {origin.x, origin.y, origin.z, 0.0f, direction.x, direction.y, direction.z, tmax};
    return ray;
}

static inline void add_radiance(global float* radiance, uint path, float3 value) {
    vstore3(vload3(path, radiance) + value, path, radiance);
}

/// The share of emission that belongs to the path; the rest was or will be found by sampling the lights. `light` is
/// the triangle's TriangleLight::primitive, `normal` that of the surface before, for the tree.
static inline float emission_weight(const Lights* lights, const Surface* surface, float emission, uint light, float t,
                                    Ray ray, float3 normal, float pdf) {
    if (!TRIANGLE_LIGHTS || pdf == 0.0f) return 1.0f;
    const float cosine = fabs(dot(surface->geometric, -(float3)(ray.dx, ray.dy, ray.dz)));
    const float3 from = (float3)(ray.ox, ray.oy, ray.oz);
    return bsdf_weight(
        pdf, triangle_light_pdf(lights, emission, light, from, normal, t * t, cosine));
}

#if LIGHTS
/// A light as seen from the surface: from the viewer's side, or from behind where light goes through. False where none can
/// arrive.
static inline bool view_light_beside(const Lights* lights, const Surface* surface, bool viewers_side, uint choice,
                                     float2 random, float3* from, LightView* view) {
    const bool lifted = leave_for_light(surface, viewers_side, from);
    if (!view_light(lights, *from, surface->shading, choice, random, view)) return false;
    const float above = dot(view->direction, surface->geometric);
    if (lifted && above <= 0.0f) return dot(view->direction, surface->shading) > 0.0f;
    return viewers_side ? above > 0.0f : above < 0.0f;
}

/// A shadow ray to a light picked at random.
static inline NextShadow sample_light(const Lights* lights, const SurfaceSamples* samples, PathState state,
                                      const Surface* surface, const MaterialData* material,
                                      global const float* energy_tables, Frame shading_frame, float3 outgoing,
                                      uint choice) {
    NextShadow next;
    next.wanted = false;
    const float2 random = floats_of(words_at(samples, AT_LIGHT));
    float3 from;
    LightView view;
    bool viewers_side = true;
    if (!view_light_beside(lights, surface, true, choice, random, &from, &view)) {
        if (!is_translucent(material)) return next;
        viewers_side = false;
        if (!view_light_beside(lights, surface, false, choice, random, &from, &view)) return next;
    }
    const float3 incoming = to_local(shading_frame, view.direction);
    if (incoming.z > 0.0f != viewers_side) return next;  // the shading normal says otherwise than the triangle
    float bsdf_pdf;
    const float3 reflected = eval_bsdf(material, energy_tables, to_local(shading_frame, outgoing), incoming,
                                       surface->inside, &bsdf_pdf);
    float weight = view.pdf > 0.0f ? light_weight(view.pdf, bsdf_pdf) : 1.0f;
#if NORMALS
    // sample_direction does not go below the triangle's plane.
    if (TECHNIQUES != 2 && viewers_side && dot(view.direction, surface->geometric) <= 0.0f) weight = 1.0f;
#endif
    const float3 light_sum = throughput_of(state) * reflected * view.radiance * weight;
    if (light_sum.x == 0.0f && light_sum.y == 0.0f && light_sum.z == 0.0f) return next;
    next.wanted = true;
    next.ray = make_ray(from, view.towards, view.reach);
    next.light.r = light_sum.x, next.light.g = light_sum.y, next.light.b = light_sum.z;
    next.light.path = state.path;
    return next;
}
#endif

/// The ray on which the path goes on, if it does.
static inline NextRay sample_direction(const SurfaceSamples* samples, uint depth, PathState state, const Surface* surface,
                                       const MaterialData* material, global const float* energy_tables,
                                       Frame shading_frame, float3 outgoing, float chance, float lobe) {
    NextRay next;
    next.wanted = false;
    BsdfSample sample;
    if (!sample_bsdf(material, energy_tables, to_local(shading_frame, outgoing), surface->inside,
                     (float3)(floats_of(words_at(samples, AT_BSDF)), lobe), &sample))
        return next;
    float3 direction = to_world(shading_frame, sample.incoming);
    const bool viewers_side = sample.incoming.z > 0.0f;
    const float above = dot(direction, surface->geometric);
    if ((above > 0.0f) != viewers_side) {  // the shading normal says otherwise than the triangle
        if (sample.pdf > 0.0f) return next;
        direction -= 2.0f * above * surface->geometric;
    }
    float3 throughput = throughput_of(state) * sample.weight;
    if (depth + 1 >= ROULETTE_DEPTH) {
        const float survival = fmin(largest(throughput), 1.0f);
        if (chance >= survival) return next;
        throughput /= survival;
    }
    next.wanted = largest(throughput) > 0.0f;
    next.ray = make_ray(leave_surface(surface, viewers_side), direction, INFINITY);
    next.state.throughput_r = throughput.x, next.state.throughput_g = throughput.y, next.state.throughput_b = throughput.z;
    next.state.pdf = sample.pdf;
    next.state.path = state.path;
    return next;
}

/// The footprint of a camera ray: a pixel.
static inline RayCone camera_cone(FrameData frame) {
    const CameraData c = frame.camera;
    const RayCone cone = {0.0f, 2.0f * length((float3)(c.up_x, c.up_y, c.up_z)) / (float)frame.height};
    return cone;
}

/// A scattered ray stands for its neighbours in the lobe that it was drawn from: its cone has a 64th of the solid angle for
/// which the density stands. Mirrors keep the cone.
static inline RayCone scattered_cone(RayCone cone, float distance, float pdf) {
    const RayCone next = {cone.width + cone.spread * distance, pdf > 0.0f ? fmax(cone.spread, 0.25f * rsqrt(PI * pdf)) : cone.spread};
    return next;
}

/// Works on the hit of one ray: radiance is added at once, rays to be traced are returned. `shading_normals` (a path each)
/// goes from one surface to the next where there is a tree of lights.
static CLARAY_OUTLINED void shade_hit(Batch batch, FrameData frame, uint depth, SCENE_PARAMETERS, Ray ray, SceneHit found,
                                      float time, PathState state, RayCone cone, global float* radiance,
                                      global float* shading_normals, NextRay* next, NextShadow* shadow) {
    next->wanted = shadow->wanted = false;
    Lights lights = make_lights(frame.lights, LIGHT_BUFFERS);
#if LAMP_IMAGES
    lights.textures = textures, lights.indices = indices;
    lights.triangle_materials = triangle_materials, lights.materials = materials;
#endif
    const float3 direction = (float3)(ray.dx, ray.dy, ray.dz), outgoing = -direction;
#if INSTANCES
    const Hit hit = hit_in_scene(found, instances);
#else
    const Hit hit = found;
#endif
    if (hit.primitive == CLARAY_MISS) {
#if SKY || ENVIRONMENT
        add_radiance(radiance, state.path,
                     throughput_of(state) * background_radiance(&lights, frame.sky, direction, state.pdf));
#endif
        return;
    }
#if INSTANCES
    const Placement placement = placement_of(found.instance, time INSTANCE_BUFFERS);
    Surface surface = surface_of_instance(hit, &placement, outgoing, positions, indices, normals);
#else
    Surface surface = surface_at(hit, outgoing, positions, indices, normals);
#endif
    MaterialData material = materials[triangle_materials[hit.primitive]];
#if BAKE
    if (depth == 0) {
        material.kind = CLARAY_LAMBERT;
        material.albedo_r = material.albedo_g = material.albedo_b = 1.0f;
        material.emission_r = material.emission_g = material.emission_b = 0.0f;
    }
#endif
#if TEXTURES
    MapValues maps = {false, (float3)(0.0f)};
    if (textures && !(BAKE && depth == 0))
        maps = apply_maps(textures, triangle_materials[hit.primitive], indices, hit, outgoing,
                          cone.width + cone.spread * hit.t, &surface, &material);
#endif
#if ABSORPTION
    if (surface.inside) state = attenuated(state, transmittance_of(&material, hit.t));
#endif
    const float3 emission = (float3)(material.emission_r, material.emission_g, material.emission_b);
    if (largest(emission) > 0.0f) {
        const bool by_tree = LIGHT_TREE && lights.data.tree_probability > 0.0f && depth > 0;
        const float3 normal = by_tree ? load3(shading_normals, state.path) : (float3)(0.0f);
#if INSTANCES
        const uint number = instances[found.instance].tag + found.primitive;
        const float sampled = INSTANCE_MOTION && placed[found.instance].moves ? 0.0f : material.sampled_emission;
#else
        const uint number = hit.primitive;
        const float sampled = material.sampled_emission;
#endif
        add_radiance(radiance, state.path,
                     throughput_of(state) * emission *
                         emission_weight(&lights, &surface, sampled, number, hit.t, ray, normal, state.pdf));
    }
#if TEXTURES && LIGHT_MAPS
    if (maps.has_light && !surface.inside) {
        add_radiance(radiance, state.path, throughput_of(state) * albedo_of(&material) * maps.light * INV_PI);
        return;
    }
#endif
    if (depth >= frame.max_depth) return;
    if (!CAUSTICS && state.pdf > 0.0f && is_delta(&material)) return;

    const SurfaceSamples samples = samples_at(samples_of(batch, state.path, frame.seed), depth);
    const SamplePair choice = words_at(&samples, AT_CHOICE);
    const Frame shading_frame = make_frame(surface.shading);
    float lobe = 0.0f;
#if LOBES
    const float2 lobes = floats_of(words_at(&samples, AT_LOBE));
    resolve_principled(&material, lobes.x);
    lobe = lobes.y;
#endif
#if LIGHTS
    if (lights.data.count != 0 && !is_delta(&material))
        *shadow = sample_light(&lights, &samples, state, &surface, &material, energy_tables, shading_frame,
                               outgoing, choice.x);
#endif
#if LIGHT_TREE && TRIANGLE_LIGHTS
    if (lights.data.tree_probability > 0.0f) vstore3(surface.shading, state.path, shading_normals);
#endif
    *next = sample_direction(&samples, depth, state, &surface, &material, energy_tables, shading_frame, outgoing,
                             unit_float(choice.y), lobe);
#if MIPMAPS
    if (next->wanted) next->cone = scattered_cone(cone, hit.t, next->state.pdf);
#endif
}

/// Where shade_sixteen.clh does the work.
#define SHADE_SIXTEEN                                                                                                      \
    (SIXTEEN && CLARAY_CPU && MATERIALS == 1u << CLARAY_LAMBERT && !NORMALS && !TEXTURES && !MIPMAPS && !INSTANCES && !BAKE && \
     !ENVIRONMENT && !SPOT_LIGHTS && !DIRECTIONAL_LIGHTS && !LIGHT_FALLOFF && !ABSORPTION &&                 \
     !(TRIANGLE_LIGHTS && POINT_LIGHTS))
#if SHADE_SIXTEEN
#include "render/shade_sixteen.clh"
#endif

/// Shades the first *length rays, which have met `depth` surfaces before this one. Fills the next queue and, under LIGHTS,
/// the queue of shadow rays; both lengths begin at 0.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void shade_surface(Batch batch, FrameData frame, uint depth, SCENE_PARAMETERS, global const uint* length, uint capacity,
                   global const Ray* rays, global const SceneHit* hits, global const PathState* states, global float* radiance,
                   global float* shading_normals,
                   global uint* next_length, global Ray* next_rays, global PathState* next_states,
                   global uint* shadow_length, global Ray* shadow_rays, global LightSample* shadow_light,
                   global const RayCone* cones, global RayCone* next_cones TIME_PARAMETERS) {
    const uint all = min(*length, capacity);
#if SHADE_SIXTEEN
    const uint begin = (uint)get_global_id(0) * PATHS_PER_ITEM, end = min(begin + PATHS_PER_ITEM, all);
    Shaded16 shaded;
    for (uint i = begin; i < end; i += 16) {
        shade_sixteen(batch, frame, depth, SCENE, rays + i, hits + i, states + i, min(16u, end - i), radiance, shading_normals,
                      &shaded);
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
        next.wanted = shadow.wanted = false;
        float time = 0.0f;
        if (i < all) {
            RayCone cone = camera_cone(frame);
#if MIPMAPS
            if (cones && depth != 0) cone = cones[i];
#endif
#if INSTANCE_MOTION
            time = times[i];
#endif
            shade_hit(batch, frame, depth, SCENE, rays[i], hits[i], time, states[i], cone, radiance, shading_normals, &next,
                      &shadow);
        }

        const uint slot = RESERVE_SLOT(next_length, next.wanted, scratch);
        if (next.wanted) {
            next_rays[slot] = next.ray;
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
            shadow_rays[shadow_slot] = shadow.ray;
            shadow_light[shadow_slot] = shadow.light;
#if INSTANCE_MOTION
            shadow_times[shadow_slot] = time;
#endif
        }
#endif
    }
#endif
}
