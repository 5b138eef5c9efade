// AOVs: data of the first surfaces that camera rays meet.
#include "claray/shared/lists/aovs.h"
#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "shade/surface_at_hit.clh"

/// What a camera ray meets. `at` is of a hit only.
typedef struct Seen {
    bool missed;
    Hit hit;
    uint material;
    Visits visits;
    ShadingPoint at;
} Seen;

static inline float aov_depth(const Seen* seen) { return seen->missed ? INFINITY : seen->hit.t; }
static inline float3 aov_normal(const Seen* seen) { return seen->missed ? (float3)(0.0f) : seen->at.surface.shading; }
static inline uint aov_primitive(const Seen* seen) { return seen->hit.primitive; }
static inline uint aov_material(const Seen* seen) { return seen->material; }
static inline uint aov_heat(const Seen* seen) { return seen->visits.nodes + seen->visits.triangles; }

/// Denoisers expect values from 0 to 1 that differ between surfaces, including lamps.
static inline float3 aov_albedo(const Seen* seen) {
    if (seen->missed) return (float3)(0.0f);
    const MaterialData* m = &seen->at.material;
    return fmin(albedo_of(m) + (float3)(m->emission_r, m->emission_g, m->emission_b), 1.0f);
}

// What a pixel consists of, by the kind of AOV. Macros, since the host compares the names of types.
#define WORD_distance float
#define WORD_direction float
#define WORD_color float
#define WORD_identifier uint
#define WORD_count uint

static inline void write_distance(float pixel, uint i, global float* to) { to[i] = pixel; }
static inline void write_direction(float3 pixel, uint i, global float* to) { vstore3(pixel, i, to); }
static inline void write_color(float3 pixel, uint i, global float* to) { vstore3(pixel, i, to); }
static inline void write_identifier(uint pixel, uint i, global uint* to) { to[i] = pixel; }
static inline void write_count(uint pixel, uint i, global uint* to) { to[i] = pixel; }

#define PARAMETER(name, kind, letters, meaning) , global WORD_##kind* name
#define WRITE(name, kind, letters, meaning) write_##kind(aov_##name(&seen), i, name);

/// For the first `step.capacity` rays.
kernel void write_aovs(Step step, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits,
                       global const Visits* visits CLARAY_AOVS(PARAMETER)) {
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    Seen seen;
    seen.hit = hit_of(hits[i] INSTANCE_BUFFERS);
    seen.missed = seen.hit.primitive == CLARAY_MISS;
    seen.material = seen.missed ? CLARAY_MISS : material_number_at(&step.frame, tables, seen.hit);
    seen.visits = visits[i];
    if (!seen.missed) surface_seen(&step.frame, SCENE, rays[i], hits[i], &seen.at);
    CLARAY_AOVS(WRITE)
}
