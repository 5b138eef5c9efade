// Guides of the denoiser: what the camera rays of a pixel see, directly or through mirrors and smooth glass. The rays are those of
// the film's samples, so that the mean of what they see has the same noise as the film; further rays of the same sequence give a
// mean with less.
#include "claray/shared/denoise.h"
#include "render/first_ray.clh"
#include "render/queue.clh"
#include "render/shade_hit.clh"

#define LEAST_ALBEDO 0.02f  // darker surfaces count as this, so that light that their coats reflect is finite per albedo
#define MOST_MIRRORS 6u     // a glass ball seen in another one
#define GLOSSY_DENSITY 1.0f  // per steradian: directions sampled with more than this come from an almost mirror
#define LEAST_NOISE 0.1f     // of a ray's glow, over the brightest nearby
#define FEW_RAYS 4.0f

/// The pixel of element i of a batch, and its first sample to trace: consecutive pixels, or consecutive elements of a list.
static inline uint2 guided_pixel(const GuideStep* guide, uint i, global const uint* list) {
    const uint element = guide->step.batch.first_pixel + i;
    return guide->listed ? vload2(element, list) : (uint2)(element, 0u);
}

/// The run of a ray of the batch.
static inline GuideRun run_of_ray(const GuideStep* guide, global const GuideRun* runs, uint ray) {
    uint run = guide->run_count - 1u;
    while (run != 0u && ray < runs[run].first_ray) --run;
    return runs[run];
}

/// The state of a camera ray's path.
static inline PathState guided_state(const GuideStep* guide, global const GuideRun* runs, uint ray, global const uint* list) {
    const GuideRun run = run_of_ray(guide, runs, ray);
    const uint within = ray - run.first_ray, pixel = within / run.samples;
    const uint2 from = guided_pixel(guide, run.first_pixel + pixel, list);
    const PathState state = {1.0f, 1.0f, 1.0f, 0.0f, 0u, from.x, from.y + within - pixel * run.samples, 0u};
    return state;
}

#if CLARAY_CPU
/// Camera rays of each pixel. Sixteen per work-item, as in generate_rays.cl. `ray_count` and `next_count`: the
/// numbers of rays of the first two depths.
kernel void guide_rays(GuideStep guide, global const GuideRun* runs, global const uint* list, global Ray* rays, global float* times,
                       global uint* ray_count, global uint* next_count) {
    const uint begin = 16u * (uint)get_global_id(0), all = guide.step.capacity;
    if (begin == 0u) *ray_count = all, *next_count = 0u;
    if (begin >= all) return;
    uint pixel[16], number[16];
    const uint count = min(16u, all - begin);
    for (uint i = 0; i < 16; ++i) {
        const PathState state = guided_state(&guide, runs, begin + min(i, count - 1u), list);
        pixel[i] = state.pixel, number[i] = state.sample;
    }
    const uint16 pixels = vload16(0, pixel), seeds = hash_words16(pixels, (uint16)(guide.step.frame.seed));
    store_first_rays16(&guide.step.frame, pixels, seeds, vload16(0, number), 0u, count, rays + begin, times + begin);
}
#else
/// Camera rays of each pixel. `ray_count` and `next_count`: the numbers of rays of the first two depths.
kernel void guide_rays(GuideStep guide, global const GuideRun* runs, global const uint* list, global Ray* rays, global float* times,
                       global uint* ray_count, global uint* next_count) {
    const uint i = get_global_id(0);
    if (i == 0u) *ray_count = guide.step.capacity, *next_count = 0u;
    if (i >= guide.step.capacity) return;
    float time = 0.0f;
    store_ray(&rays[i], first_ray(&guide.step.frame, guided_state(&guide, runs, i, list), &time));
    if (INSTANCE_MOTION) times[i] = time;
}
#endif

static inline float3 albedo_there(const ShadingPoint* at) { return fmax(albedo_of(&at->material), LEAST_ALBEDO); }

/// The next ray, if the surface is a mirror, smooth glass or almost a mirror; the path of the film's sample takes the same, unless it
/// goes to a hot spot.
static inline NextRay pass_mirror(const FrameData* frame, SCENE_PARAMETERS, uint depth, Ray ray, PathState state,
                                  ShadingPoint* at) {
    NextRay next;
    next.wanted = false;
    if (CLARAY_IS_DIFFUSE(at->material.kind) && at->material.layers == 0u) return next;
    const SurfaceSamples samples = samples_at(samples_of(state, frame->seed), depth);
    float lobe;
    prepare_shading(frame, SCENE, &samples, -(float3)(ray.dx, ray.dy, ray.dz), at, &lobe);
    const bool delta = is_delta(&at->material);
    next = scatter(frame, 0, false, 0, &samples, depth, state, at, unit_float(words_at(&samples, AT_CHOICE).x), lobe);
    next.wanted = next.wanted && (delta || next.state.pdf > GLOSSY_DENSITY);
    return next;
}

/// Reads whole vectors: beside a member of 64 bits, NVIDIA's compiler reads word by word, and write_guides took 1.4 times as long.
static inline Sight sight_at(global const Sight* from) {
    Sight sight;
    for (uint i = 0; i < sizeof(Sight) / sizeof(float4); ++i) ((float4*)&sight)[i] = ((global const float4*)from)[i];
    return sight;
}

/// As shade_hit, without the light that rough surfaces reflect. Adds to `seen`, which depth 0 begins; `next` is wanted if the ray goes on.
static CLARAY_OUTLINED void see(PathState state, const Step* step, SCENE_PARAMETERS, Ray ray, SceneHit found, float time, global Sight* seen,
                                NextRay* next) {
    const FrameData* frame = &step->frame;
    const uint depth = step->depth;
    Sight sight = {0};
    sight.throughput_r = sight.throughput_g = sight.throughput_b = 1.0f;
    if (depth != 0u) sight = sight_at(seen);
    const Lights lights = lights_of(frame, SCENE);
    state.throughput_r = sight.throughput_r, state.throughput_g = sight.throughput_g, state.throughput_b = sight.throughput_b;
    state.pdf = sight.pdf;
    next->wanted = false;
    const Hit hit = hit_of(found INSTANCE_BUFFERS);
    float3 glow, albedo = (float3)(0.0f);
    ShadingPoint at;
    PathSegment segment = camera_segment(frame, ray, time);
#define CLARAY_LOAD(name, type, words, TAKEN) segment.name = sight.name;
    CLARAY_ALONG_SIGHTS(CLARAY_LOAD)
#undef CLARAY_LOAD
    const bool goes_on = arrive(0, step, &lights, 0u, SCENE, &segment, found, 0, &state, &glow, &at);
    if (hit.primitive != CLARAY_MISS) {
        if (depth == 0u) {
            sight.normal_x = at.surface.shading.x, sight.normal_y = at.surface.shading.y, sight.normal_z = at.surface.shading.z;
            sight.nearness = 1.0f / fmax(hit.t, 1e-30f);
        }
        albedo = throughput_of(state) * albedo_there(&at);
        if (goes_on && depth + 1u < min(MOST_MIRRORS, frame->max_depth)) *next = pass_mirror(frame, SCENE, depth, ray, state, &at);
    }
    if (sight.passed == CLARAY_BY_GLOSS) {
        sight.gloss_r += glow.x, sight.gloss_g += glow.y, sight.gloss_b += glow.z;
    } else {
        sight.glow_r += glow.x, sight.glow_g += glow.y, sight.glow_b += glow.z;
        sight.albedo_r = albedo.x, sight.albedo_g = albedo.y, sight.albedo_b = albedo.z;
    }
    if (next->wanted) {
        sight.pdf = next->state.pdf;
#define CLARAY_STORE(name, type, words, TAKEN) \
        if (TAKEN) sight.name = next->segment.name;
        CLARAY_ALONG_SIGHTS(CLARAY_STORE)
#undef CLARAY_STORE
        sight.passed = max(sight.passed, next->state.pdf > 0.0f ? CLARAY_BY_GLOSS : CLARAY_BY_MIRROR);
        sight.throughput_r = next->state.throughput_r, sight.throughput_g = next->state.throughput_g;
        sight.throughput_b = next->state.throughput_b;
    }
    *seen = sight;
}

/// A ray that goes on, and its index among the camera rays.
typedef struct SeenRay {
    NextRay next;
    uint number;
    float time;  // under INSTANCE_MOTION
} SeenRay;

/// Ray i of this depth. `numbers`: from depth 1 on the index of each ray among the camera rays.
static inline void see_ray(const GuideStep* guide, global const GuideRun* runs, global const uint* list, SCENE_PARAMETERS, global const Ray* rays,
                           SceneHit found, global const uint* numbers, uint i, global Sight* sights, SeenRay* seen) {
    seen->number = guide->step.depth == 0u ? i : numbers[i];
    const PathState state = guided_state(guide, runs, seen->number, list);
    seen->time = INSTANCE_MOTION ? time_of(samples_of(state, guide->step.frame.seed)) : 0.0f;
    see(state, &guide->step, SCENE, queued_ray(&rays[i]), found, seen->time, &sights[seen->number], &seen->next);
}

static inline void append_ray(const SeenRay* seen, uint slot, global Ray* next_rays, global float* next_times, global uint* next_numbers) {
    store_ray(&next_rays[slot], seen->next.segment.ray);
    next_numbers[slot] = seen->number;
    if (INSTANCE_MOTION) next_times[slot] = seen->time;
}

/// Rays that a work-item of a CPU sees, and for which it reserves slots at once: threads would wait for each other at every atomic operation.
#define RAYS_PER_ITEM (CLARAY_CPU ? 16u : 1u)

/// Rays that go on are appended to the `next` ones. `ray_count`: how many there are; `next_count` is 0 before, and `count_after_next` is made 0.
kernel void see_surfaces(GuideStep guide, global const GuideRun* runs, global const uint* list, SCENE_PARAMETERS, global const Ray* rays,
                         global const SceneHit* hits, global const uint* numbers, global Sight* sights, global Ray* next_rays, global float* next_times,
                         global uint* next_numbers, global const uint* ray_count, global uint* next_count, global uint* count_after_next) {
    const uint begin = RAYS_PER_ITEM * (uint)get_global_id(0), end = min(begin + RAYS_PER_ITEM, min(guide.step.capacity, *ray_count));
    if (begin == 0u) *count_after_next = 0u;
    SceneHit found[RAYS_PER_ITEM];  // loaded together: one after the other, each would wait for memory
    for (uint i = begin; i < end; ++i) found[i - begin] = hits[i];
    SeenRay seen[RAYS_PER_ITEM];
    uint wanted = 0u;
    for (uint i = begin; i < end; ++i) {
        see_ray(&guide, runs, list, SCENE, rays, found[i - begin], numbers, i, sights, &seen[wanted]);
        if (seen[wanted].next.wanted) ++wanted;
    }
    if (wanted == 0u) return;
    const uint slot = atomic_add(next_count, wanted);
    for (uint k = 0; k < wanted; ++k) append_ray(&seen[k], slot + k, next_rays, next_times, next_numbers);
}

/// From sums of n values and of their squares. One value tells no variance: there it is the square.
static inline float3 variances_of_means(float3 sums, float3 squares, uint n) {
    const float3 means = sums / (float)n;
    return n < 2 ? means * means : fmax(squares / (float)n - means * means, 0.0f) / (float)(n - 1);
}

/// Adds further rays to those of `all`. `of_film`: the share of these among the film's samples that are now traced.
static inline void merge_guides(Guide* all, const Guide* more, float of_film) {
    const float share = (float)more->rays / (float)(all->rays + more->rays), rest = 1.0f - share;
#define MIXED(member) all->member = lerp(all->member, more->member, share)
    const float shift = luminance((float3)(more->glow_r + more->gloss_r, more->glow_g + more->gloss_g, more->glow_b + more->gloss_b) -
                                  (float3)(all->glow_r + all->gloss_r, all->glow_g + all->gloss_g, all->glow_b + all->gloss_b));
    MIXED(ray_variance), all->ray_variance += share * rest * shift * shift;
    MIXED(albedo_r), MIXED(albedo_g), MIXED(albedo_b);
    MIXED(glow_r), MIXED(glow_g), MIXED(glow_b);
    MIXED(gloss_r), MIXED(gloss_g), MIXED(gloss_b);
    MIXED(mirrored), MIXED(normal_x), MIXED(normal_y), MIXED(normal_z), MIXED(nearness);
#undef MIXED
#define MIXED(member) all->member = lerp(all->member, more->member, of_film)
    MIXED(sampled_albedo_r), MIXED(sampled_albedo_g), MIXED(sampled_albedo_b);
    MIXED(sampled_glow_r), MIXED(sampled_glow_g), MIXED(sampled_glow_b);
#undef MIXED
#define MIXED(member) all->member = rest * rest * all->member + share * share * more->member
    MIXED(albedo_variance), MIXED(glow_variance), MIXED(gloss_variance);
#undef MIXED
    all->odd_glow += more->odd_glow, all->rays += more->rays, all->complete = more->complete;
}

static inline Glow glow_of(const Guide* g) {
    const float3 both = (float3)(g->glow_r + g->gloss_r, g->glow_g + g->gloss_g, g->glow_b + g->gloss_b);
    const Glow glow = {luminance(both), g->ray_variance, g->rays};
    return glow;
}

/// Sums over sights. The last component of each vector is a sum of its own.
typedef struct SightSums {
    float4 albedo, glow, gloss;            // and the squares of their luminances
    float4 luminances;                     // of albedo, glow and gloss; and how many mirrors, glass and almost mirrors passed on
    float4 normal;                         // and nearness
    float4 sampled_albedo, sampled_glow;   // of the film's samples. And the luminance of glow and gloss: of those of odd index, and squared
} SightSums;

static inline void add_sight(SightSums* sums, global const Sight* from, bool is_odd) {
    const Sight sight = sight_at(from);
    const float3 albedo = (float3)(sight.albedo_r, sight.albedo_g, sight.albedo_b);
    const float3 glow = (float3)(sight.glow_r, sight.glow_g, sight.glow_b);
    const float3 gloss = (float3)(sight.gloss_r, sight.gloss_g, sight.gloss_b);
    const float3 bright = (float3)(luminance(albedo), luminance(glow), luminance(gloss)), squares = bright * bright;
    sums->albedo += (float4)(albedo, squares.x), sums->glow += (float4)(glow, squares.y), sums->gloss += (float4)(gloss, squares.z);
    sums->luminances += (float4)(bright, sight.passed ? 1.0f : 0.0f);
    sums->normal += (float4)(sight.normal_x, sight.normal_y, sight.normal_z, sight.nearness);
    if (is_odd) sums->sampled_albedo.w += bright.y + bright.z;
    sums->sampled_glow.w += (bright.y + bright.z) * (bright.y + bright.z);
}

/// Of every `step`th sight from `first` on. The film's samples come first; they begin at an odd index if `parity` is 1.
static inline SightSums sum_of_sights(global const Sight* sights, uint first, uint step, uint samples, uint sampled, uint parity) {
    SightSums sums = {0};
    uint s = first;
    for (; s < sampled; s += step) add_sight(&sums, &sights[s], (s + parity) % 2 != 0);
    sums.sampled_albedo.xyz = sums.albedo.xyz, sums.sampled_glow.xyz = sums.glow.xyz + sums.gloss.xyz;
    for (; s < samples; s += step) add_sight(&sums, &sights[s], false);
    return sums;
}

#if CLARAY_CPU
#define LANES_OF_EDGE 1u
#define ADD_UP_LANES(own, lane)
#else
#define LANES_OF_EDGE CLARAY_LANES_OF_EDGE
/// Lane 0 gets the sum of the lanes of its pixel. All work-items of the group take part.
static inline void add_up_lanes(SightSums* own, uint lane, local SightSums* group) {
    const uint i = get_local_id(0);
    group[i] = *own;
    for (uint apart = LANES_OF_EDGE / 2u; apart != 0u; apart /= 2u) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (lane >= apart) continue;
        for (uint k = 0; k < sizeof(SightSums) / sizeof(float4); ++k) ((local float4*)&group[i])[k] += ((local const float4*)&group[i + apart])[k];
    }
    *own = group[i];
}
#define ADD_UP_LANES(own, lane)            \
    local SightSums group[CLARAY_GUIDE_GROUP]; \
    if (step.listed) add_up_lanes(own, lane, group)
#endif

static inline Guide guide_of(const SightSums* sums, uint samples, uint sampled) {
    Guide guide = {0};
    const float of_film = sampled == 0u ? 0.0f : 1.0f / (float)sampled, share = 1.0f / (float)samples;
#define MEAN(member, sum, share) guide.member##_r = share * sums->sum.x, guide.member##_g = share * sums->sum.y, guide.member##_b = share * sums->sum.z
    MEAN(sampled_albedo, sampled_albedo, of_film), MEAN(sampled_glow, sampled_glow, of_film);
    MEAN(albedo, albedo, share), MEAN(glow, glow, share), MEAN(gloss, gloss, share);
#undef MEAN
    guide.odd_glow = sums->sampled_albedo.w;
    const float3 squares = (float3)(sums->albedo.w, sums->glow.w, sums->gloss.w);
    const float3 variances = variances_of_means(sums->luminances.xyz, squares, samples);
    const float mean = share * (sums->luminances.y + sums->luminances.z);
    guide.albedo_variance = variances.x, guide.glow_variance = variances.y, guide.gloss_variance = variances.z;
    guide.normal_x = share * sums->normal.x, guide.normal_y = share * sums->normal.y, guide.normal_z = share * sums->normal.z;
    guide.nearness = share * sums->normal.w, guide.mirrored = share * sums->luminances.w;
    guide.ray_variance = fmax(share * sums->sampled_glow.w - mean * mean, 0.0f), guide.rays = samples;
    return guide;
}

/// One pixel per item; of a list, LANES_OF_EDGE items per pixel. The film's samples come first in each pixel's sequence.
kernel void write_guides(GuideStep step, global const GuideRun* runs, global const uint* list, global const FilmPixel* film,
                         global const Sight* sights, global Guide* guides, global Glow* glows) {
    const uint lanes = step.listed ? LANES_OF_EDGE : 1u, lane = get_global_id(0) % lanes, pixels = step.step.batch.pixels;
    const uint i = min((uint)get_global_id(0) / lanes, pixels - 1u);
    uint run = step.run_count - 1u;
    while (run != 0u && i < runs[run].first_pixel) --run;
    const uint samples = runs[run].samples, first = runs[run].first_ray + (i - runs[run].first_pixel) * samples;
    const uint2 pixel = guided_pixel(&step, i, list);
    const uint in_film = film[pixel.x].count + film[pixel.x].dropped, end = pixel.y + samples;
    const uint end_of_film = in_film == 0u ? end : min(in_film, end), sampled = end_of_film - min(pixel.y, end_of_film);
    SightSums sums = sum_of_sights(sights + first, lane, lanes, samples, sampled, pixel.y % 2u);
    ADD_UP_LANES(&sums, lane);
    if (lane != 0u || get_global_id(0) / lanes >= pixels) return;
    Guide guide = guide_of(&sums, samples, sampled);
    guide.complete = in_film <= end;
    if (pixel.y != 0u) {
        Guide all = guides[pixel.x];
        merge_guides(&all, &guide, (float)sampled / (float)max(end_of_film, 1u));
        guide = all;
    }
    guides[pixel.x] = guide;
    glows[pixel.x] = glow_of(&guide);
}

/// Sorts the pixels by the variance of one ray's glow, a factor of 2 to a class: borders of lamps and of the sky, where the film's noise is
/// that of coverage, and highlights. `counts`, of the pixels in each class, are 0 before.
kernel void find_edges(uint width, uint height, global const Glow* glows, global uchar* classes, global uint* counts) {
    const uint i = get_global_id(0);
    if (i >= width * height) return;
    const int x = (int)(i % width), y = (int)(i / width);
    float variance = 0.0f, most = 0.0f, first = 0.0f, second = 0.0f;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int at = clamp(y + dy, 0, (int)height - 1) * (int)width + clamp(x + dx, 0, (int)width - 1);
            const float glow = glows[at].mean;
            variance += glows[at].variance, first += glow, second += glow * glow;
            most = glow > most ? glow : most;
        }
    variance /= 9.0f, first /= 9.0f, second /= 9.0f;
    // Few rays may have missed what others nearby have met, and all of them a border between two pixels. The part of the pixel beyond that
    // border becomes smaller with the number of rays, too.
    const float missed = fmin(FEW_RAYS / (float)glows[i].rays, 1.0f);
    variance = lerp(glows[i].variance, variance + missed * fmax(second - first * first, 0.0f), missed);
    const bool is_edge = variance > LEAST_NOISE * LEAST_NOISE * most * most;  // a slow gradient, as in the sky, is none
    const int exponent = (int)(as_uint(variance) >> 23) - 127;
    const uchar class = is_edge ? (uchar)clamp(exponent + (int)CLARAY_EDGE_CLASSES / 2, 0, (int)CLARAY_EDGE_CLASSES - 1) : (uchar)CLARAY_EDGE_CLASSES;
    classes[i] = class;
    if (is_edge) atomic_inc(&counts[class]);
}

/// Lists the edges by class, in any order, and from which sample on they are traced. `ends`: where the next pixel of each class goes.
kernel void list_edges(uint pixels, global const Glow* glows, global const uchar* classes, global uint* list,
                       global uint* ends) {
    const uint i = get_global_id(0);
    if (i >= pixels || classes[i] >= CLARAY_EDGE_CLASSES) return;
    vstore2((uint2)(i, glows[i].rays), atomic_inc(&ends[classes[i]]), list);
}
