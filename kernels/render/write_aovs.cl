// AOVs: data of the first surfaces that camera rays meet.
#include "claray/shared/lists/aovs.h"
#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "shade/camera.clh"
#include "shade/surface_at_hit.clh"

/// What a camera ray meets. `at` is of a hit only.
typedef struct Seen {
    bool missed;
    Hit hit;
    uint material, instance;
    float2 uv, motion;
    Visits visits;
    ShadingPoint at;
} Seen;

static inline float aov_depth(const Seen* seen) { return seen->missed ? INFINITY : seen->hit.t; }
static inline float3 aov_normal(const Seen* seen) { return seen->missed ? (float3)(0.0f) : seen->at.surface.shading; }
static inline uint aov_primitive(const Seen* seen) { return seen->hit.primitive; }
static inline uint aov_material(const Seen* seen) { return seen->material; }
/// The host makes the numbers of the user's meshes and instances of these (host/render/results.cpp).
static inline uint aov_object(const Seen* seen) { return seen->hit.primitive; }
static inline uint aov_instance(const Seen* seen) { return seen->instance; }
static inline float2 aov_uv(const Seen* seen) { return seen->uv; }
static inline float2 aov_motion(const Seen* seen) { return seen->motion; }
static inline float3 aov_position(const Seen* seen) { return seen->missed ? (float3)(0.0f) : seen->at.surface.base + seen->at.surface.inner; }
static inline uint aov_heat(const Seen* seen) { return seen->visits.nodes + seen->visits.triangles; }

/// Denoisers expect values from 0 to 1 that differ between surfaces, including lamps.
static inline float3 aov_albedo(const Seen* seen) {
    if (seen->missed) return (float3)(0.0f);
    const MaterialData* m = &seen->at.material;
    return fmin(albedo_of(m) + (float3)(m->emission_r, m->emission_g, m->emission_b), 1.0f);
}

static inline float3 aov_emission(const Seen* seen) {
    if (seen->missed) return (float3)(0.0f);
    const MaterialData* m = &seen->at.material;
    return (float3)(m->emission_r, m->emission_g, m->emission_b);
}

/// GGX has alpha = roughness^2. A highlight of Blinn's exponent n has about alpha = sqrt(2 / (n + 2)) (Walter et al. 2007, section 5.2).
static inline float aov_roughness(const Seen* seen) {
    if (seen->missed) return 0.0f;
    const MaterialData* m = &seen->at.material;
    if (m->kind == CLARAY_MIRROR) return 0.0f;
    if (m->kind == CLARAY_LAMBERT || m->kind == CLARAY_UNLIT) return 1.0f;
    return m->kind == CLARAY_BLINN_PHONG ? sqrt(sqrt(2.0f / (m->shininess + 2.0f))) : m->roughness;
}

/// The first texture coordinates at a triangle's hit. `uvs`: of all vertices; null: there are none.
static inline float2 uv_at(global const float* uvs, global const uint* indices, Hit hit) {
    if (!uvs) return (float2)(0.0f);
    const uint3 corner = vload3(hit.primitive, indices);
    return (1.0f - hit.u - hit.v) * vload2(corner.x, uvs) + hit.u * vload2(corner.y, uvs) + hit.v * vload2(corner.z, uvs);
}

/// Where the camera of a time sees a point, from -1 to 1 on both axes, y upwards. `is_far`: the point is a direction. Returns false if it
/// does not see it.
static inline bool is_seen_at(const FrameData* frame, float time, float3 point, bool is_far, float2* place) {
    CameraData c = frame->camera;
    if (camera_moves(&c)) c = move_camera(c, time);
    const float3 right = (float3)(c.right_x, c.right_y, c.right_z), up = (float3)(c.up_x, c.up_y, c.up_z);
    const float3 to = is_far ? point : point - (float3)(c.x, c.y, c.z);
    const ProjectionPlace at = place_in_any(c.projection, dot_product(to, right) / dot_product(right, right),
                                              dot_product(to, up) / dot_product(up, up), dot_product(to, (float3)(c.forward_x, c.forward_y, c.forward_z)), c.half_width, c.half_height);
    *place = (float2)(at.x, at.y);
    return at.seen != 0u;
}

/// The pixels, to the right and down, by which a point moves in the image. `begin` and `end`: the point at shutter open and close.
static inline float2 motion_of(const FrameData* frame, float3 begin, float3 end, bool is_far) {
    float2 from, to;
    if (!is_seen_at(frame, 0.0f, begin, is_far, &from) || !is_seen_at(frame, 1.0f, end, is_far, &to)) return (float2)(0.0f);
    float2 way = (float2)(to.x - from.x, from.y - to.y);
    if (CLARAY_KIND_OF(frame->camera.projection) == CLARAY_PANORAMA) way.x -= 2.0f * rint(0.5f * way.x);  // the shorter way round
    return 0.5f * way * (float2)((float)frame->width, (float)frame->height);
}

/// The point at shutter close of a surface that is at `begin` when the shutter opens.
static inline float3 point_at_end(const FrameData* frame, SCENE_PARAMETERS, Ray ray, SceneHit found, float3 begin) {
#if INSTANCES && INSTANCE_MOTION
    if (found.instance == CLARAY_MISS || !placed[found.instance].moves) return begin;
    PathSegment segment = bare_segment(ray);
    segment.time = 1.0f;
    ShadingPoint end;
    surface_at_hit(0, frame, SCENE, &segment, found, false, &end);
    return end.surface.base + end.surface.inner;
#else
    return begin;
#endif
}

// What a pixel consists of, by the kind of AOV. Macros, since the host compares the names of types.
#define WORD_distance float
#define WORD_direction float
#define WORD_color float
#define WORD_place float
#define WORD_coordinates float
#define WORD_movement float
#define WORD_share float
#define WORD_identifier uint
#define WORD_count uint

static inline void write_distance(float pixel, uint i, global float* to) { to[i] = pixel; }
static inline void write_direction(float3 pixel, uint i, global float* to) { vstore3(pixel, i, to); }
static inline void write_color(float3 pixel, uint i, global float* to) { vstore3(pixel, i, to); }
static inline void write_place(float3 pixel, uint i, global float* to) { vstore3(pixel, i, to); }
static inline void write_coordinates(float2 pixel, uint i, global float* to) { vstore2(pixel, i, to); }
static inline void write_movement(float2 pixel, uint i, global float* to) { vstore2(pixel, i, to); }
static inline void write_share(float pixel, uint i, global float* to) { to[i] = pixel; }
static inline void write_identifier(uint pixel, uint i, global uint* to) { to[i] = pixel; }
static inline void write_count(uint pixel, uint i, global uint* to) { to[i] = pixel; }

#define PARAMETER(name, kind, letters, meaning) , global WORD_##kind* name
#define WRITE(name, kind, letters, meaning) write_##kind(aov_##name(&seen), i, name);

/// For the first `step.capacity` rays. `uvs`: as in uv_at.
kernel void write_aovs(Step step, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits,
                       global const Visits* visits, global const float* uvs CLARAY_AOVS(PARAMETER)) {
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    Seen seen;
    seen.hit = hit_of(hits[i] INSTANCE_BUFFERS);
    seen.missed = seen.hit.primitive == CLARAY_MISS;
    seen.material = seen.missed ? CLARAY_MISS : material_number_at(&step.frame, tables, seen.hit);
    seen.visits = visits[i];
    seen.uv = (float2)(0.0f), seen.instance = CLARAY_MISS;
    float3 begin = (float3)(rays[i].dx, rays[i].dy, rays[i].dz), end = begin;
    if (!seen.missed) {
        surface_seen(&step.frame, SCENE, rays[i], hits[i], &seen.at);
        if (!IS_PRIMITIVE(seen.hit)) seen.uv = uv_at(uvs, indices, seen.hit);
#if INSTANCES
        seen.instance = hits[i].instance;
#endif
        begin = aov_position(&seen);
        end = point_at_end(&step.frame, SCENE, rays[i], hits[i], begin);
    }
    seen.motion = motion_of(&step.frame, begin, end, seen.missed);
    CLARAY_AOVS(WRITE)
}

/// The primitive, the material and the instance that each of the first `step.capacity` rays met; CLARAY_MISS of what is not there.
kernel void write_numbers(Step step, SCENE_PARAMETERS, global const SceneHit* hits, global uint* numbers) {
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    const Hit hit = hit_of(hits[i] INSTANCE_BUFFERS);
    uint instance = CLARAY_MISS;
#if INSTANCES
    instance = hits[i].instance;
#endif
    const uint material = hit.primitive == CLARAY_MISS ? CLARAY_MISS : material_number_at(&step.frame, tables, hit);
    vstore3((uint3)(hit.primitive, material, instance), i, numbers);
}
