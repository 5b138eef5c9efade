// render/shade_surface.cl as one would write it by hand for flat Lambertians lit by emissive triangles, sixteen rays at once on a CPU,
// in a renderer that never heard of anything else: see bench/stripped.cpp. Parameters that the host passes are all there.
#include "claray/shared/types.h"
#include "claray/shared/scene.h"
#include "render/samples.clh"
#include "math/vector_sixteen.clh"

#define PATHS 64u
#define ROULETTE 3u

typedef struct Queued {
    uint path[16];
    Lanes16 lanes;  // from, direction, throughput, pdf, towards the light, light
} Queued;

static inline float emitted_share(global const Ray* ray, const Hit* hit, float pdf, float chosen, float density, float3 base,
                                  float3 e1, float3 e2) {
    if (pdf == 0.0f) return 1.0f;
    const float scale = scale_to_one(larger(largest(fabs(e1)), largest(fabs(e2))));
    float3 normal = unit_vector(exact_cross(scale * e1, scale * e2));
    const float3 outgoing = -(float3)(ray->dx, ray->dy, ray->dz);
    if (dot(normal, outgoing) < 0.0f) normal = -normal;
    const float other = chosen * density * (hit->t * hit->t) / fabs(dot(normal, outgoing)), ratio = other / pdf;
    return 1.0f / (1.0f + ratio * ratio);
}

static inline uint fetch(global const float* positions, global const uint* indices, global const uint* triangle_materials,
                         global const MaterialData* materials, float density, global const Ray* rays, global const Hit* hits,
                         global const PathState* states, uint begin, uint count, global float* radiance, Lanes16* corners, Lanes16* met,
                         uint* path) {
    uint surfaces = 0;
    for (uint i = 0; i < 16; ++i) {
        const uint k = min(i, count - 1);
        global const Ray* ray = &rays[k];
        const Hit hit = hits[k];
        const PathState state = states ? states[k] : (PathState){1.0f, 1.0f, 1.0f, 0.0f, begin + k};
        const bool miss = hit.primitive == CLARAY_MISS;
        const uint triangle = miss ? 0u : hit.primitive;
        global const MaterialData* material = &materials[triangle_materials[triangle]];
        const uint3 corner = vload3(triangle, indices);
        const float3 v0 = vload3(corner.x, positions), v1 = vload3(corner.y, positions), v2 = vload3(corner.z, positions);
        const float3 emission = (float3)(material->emission_r, material->emission_g, material->emission_b);
        if (i < count && !miss) {
            surfaces |= 1u << i;
            if (largest(emission) > 0.0f) {
                const float share = emitted_share(ray, &hit, state.pdf, material->sampled_emission, density, v0, v1 - v0, v2 - v0);
                const float3 throughput = (float3)(state.throughput_r, state.throughput_g, state.throughput_b);
                vstore3(vload3(state.path, radiance) + throughput * emission * share, state.path, radiance);
            }
        }
        corners->value[0][i] = v0.x, corners->value[1][i] = v0.y, corners->value[2][i] = v0.z;
        corners->value[3][i] = v1.x, corners->value[4][i] = v1.y, corners->value[5][i] = v1.z;
        corners->value[6][i] = v2.x, corners->value[7][i] = v2.y, corners->value[8][i] = v2.z;
        met->value[0][i] = -ray->dx, met->value[1][i] = -ray->dy, met->value[2][i] = -ray->dz;
        met->value[3][i] = hit.u, met->value[4][i] = hit.v;
        met->value[5][i] = material->albedo_r, met->value[6][i] = material->albedo_g, met->value[7][i] = material->albedo_b;
        met->value[8][i] = state.throughput_r, met->value[9][i] = state.throughput_g, met->value[10][i] = state.throughput_b;
        path[i] = state.path;
    }
    return surfaces;
}

static inline uint pick(uint random, uint lights, global const TriangleLight* all) {
    uint low = 0, high = lights - 1;
    while (low < high) {
        const uint middle = (low + high) / 2;
        if (all[middle].cumulative < random)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// The lanes that have a shadow ray.
static inline uint light_up(LightsData data, global const TriangleLight* all, Vectors from, Vectors normal, Vectors albedo,
                            Vectors throughput, uint16 choices, SamplePairs16 words, Lanes16* out) {
    uint choice[16];
    vstore16(choices, 0, choice);
    Lanes16 fields;
    for (uint i = 0; i < 16; ++i) {
        global const float* light = (global const float*)&all[pick(choice[i], data.count, all)];
        for (uint k = 0; k < 16; ++k) fields.value[k][i] = light[k];
    }
    const Vectors base = lane_vectors16(&fields, 0), e1 = lane_vectors16(&fields, 3), e2 = lane_vectors16(&fields, 6);
    const Vectors emission = lane_vectors16(&fields, 10);
    const float16 area = lane_values16(&fields, 9), probability = lane_values16(&fields, 15);
    const float16 random = unit_floats16(words.y), root = sqrt(unit_floats16(words.x));
    const Vectors inner = plus16(scaled16(root * (1.0f - random), e1), scaled16(root * random, e2));
    const Vectors towards = minus16(plus16(base, inner), from);
    Vectors light_normal = triangle_normals16(e1, e2);
    const int16 behind = dot16(light_normal, towards) > 0.0f;
    light_normal = flipped16(light_normal, behind);
    const Vectors more = scaled16(FLOAT_EPSILON * 24.0f, absolute16(towards));
    const float16 clearance = clearances16(base, e1, e2, light_normal, &more);
    const float16 distance2 = dot16(towards, towards);
    const Vectors direction = scaled16(reciprocal_root16(distance2), towards);
    const float16 light_cosine = -dot16(light_normal, direction), cosine = dot16(direction, normal);
    const Vectors radiance = scaled16(light_cosine * fabs(area) / (distance2 * probability), emission);
    const float16 per_area = (0.2126f * emission.x + 0.7152f * emission.y + 0.0722f * emission.z) * data.density;
    const float16 pdf = per_area * distance2 / light_cosine, lambert = cosine * INV_PI, ratio = lambert / pdf;
    const float16 weight = select((float16)(1.0f), 1.0f / (1.0f + ratio * ratio), pdf > 0.0f);
    const Vectors light = scaled16(weight, times16(times16(throughput, scaled16(lambert, albedo)), radiance));
    keep_vectors16(minus16(leave_surfaces16(base, light_normal, clearance, inner), from), out, 10);
    keep_vectors16(light, out, 13);
    return movemask16(light_cosine > 0.0f && distance2 > 0.0f && cosine > 0.0f && !(behind && area < 0.0f) &&
                      !(light.x == 0.0f && light.y == 0.0f && light.z == 0.0f));
}

/// The lanes that go on.
static inline uint scatter(Vectors normal, Frames16 frame, Vectors albedo, Vectors throughput, uint depth, uint16 chances,
                           SamplePairs16 words, Lanes16* out) {
    float16 x, y;
    const float16 random = unit_floats16(words.x), root = sqrt(random), z = sqrt(1.0f - random);
    cosines_and_sines16(unit_floats16(words.y), &x, &y);
    const Vectors direction =
        plus16(plus16(scaled16(x * root, frame.tangent), scaled16(y * root, frame.bitangent)), scaled16(z, frame.normal));
    throughput = times16(throughput, albedo);
    int16 wanted = dot16(direction, normal) > 0.0f;
    if (depth + 1 >= ROULETTE) {
        const float16 most = largest16(throughput), survival = select(most, (float16)(1.0f), most > 1.0f);
        wanted = wanted && unit_floats16(chances) < survival;
        throughput.x /= survival, throughput.y /= survival, throughput.z /= survival;
    }
    keep_vectors16(direction, out, 3);
    keep_vectors16(throughput, out, 6);
    vstore16(z * INV_PI, 0, out->value[9]);
    return movemask16(wanted && largest16(throughput) > 0.0f);
}

static inline SamplePairs16 words_of(uint16 seeds, uint16 numbers, uint dimension) {
    return sample_pair_of_16(SAMPLER, seeds, numbers, (uint16)(dimension));
}

kernel __attribute__((reqd_work_group_size(1, 1, 1)))
void shade_surface(Batch batch, FrameData frame, uint depth, global const float* positions, global const uint* indices,
                   global const float* normals, global const uint* triangle_materials, global const MaterialData* materials,
                   global const float* energy_tables, global const TriangleLight* triangle_lights,
                   global const PunctualLight* punctual_lights, global const LightNode* light_tree, global const LightLeaf* light_leaves,
                   global const LightTrail* light_trails, global const HotSpot* hot_spots, global const uint* lamps, global const float* environment_texels,
                   global const float* environment_cdf, global const uint* textures, global const uint* length, uint capacity,
                   global const Ray* rays, global const Hit* hits, global const PathState* states, global float* radiance,
                   global float* shading_normals, volatile global uint* next_length, global Ray* next_rays,
                   global PathState* next_states, volatile global uint* shadow_length, global Ray* shadow_rays,
                   global LightSample* shadow_light, global const void* cones, global void* next_cones,
                   global uint* spent, global uint* shadows_spent, global ulong* totals) {
    if (get_global_id(0) == 0) {
        totals[0] += *spent, totals[1] += *shadows_spent;
        *spent = *shadows_spent = 0;
    }
    const uint all = min(*length, capacity), begin = (uint)get_global_id(0) * PATHS, end = min(begin + PATHS, all);
    Lanes16 corners, met;
    Queued queued;
    const Lanes16* of = &queued.lanes;
    for (uint i = begin; i < end; i += 16) {
        const uint surfaces = fetch(positions, indices, triangle_materials, materials, frame.lights.density, rays + i, hits + i,
                                    depth == 0 ? 0 : states + i, i, min(16u, end - i), radiance, &corners, &met, queued.path);
        if (surfaces == 0 || depth >= frame.max_depth) continue;
        const Vectors base = lane_vectors16(&corners, 0), outgoing = lane_vectors16(&met, 0);
        const Vectors e1 = minus16(lane_vectors16(&corners, 3), base), e2 = minus16(lane_vectors16(&corners, 6), base);
        const Vectors front = triangle_normals16(e1, e2), normal = flipped16(front, dot16(front, outgoing) < 0.0f);
        const Vectors inner = plus16(scaled16(lane_values16(&met, 3), e1), scaled16(lane_values16(&met, 4), e2));
        const Vectors from = leave_surfaces16(base, normal, clearances16(base, e1, e2, normal, 0), inner);
        const Vectors albedo = lane_vectors16(&met, 5), throughput = lane_vectors16(&met, 8);
        keep_vectors16(from, &queued.lanes, 0);
        const uint16 paths = vload16(0, queued.path), pixels = paths / batch.samples;
        const uint16 seeds = hash_words_of_16(batch.first_pixel + pixels, (uint16)(frame.seed));
        const uint16 numbers = batch.first_sample + (paths - pixels * batch.samples);
        const SamplePairs16 choices = words_of(seeds, numbers, DIMENSION_CHOICE(depth));
        uint shadow = surfaces & light_up(frame.lights, triangle_lights, from, normal, albedo, throughput, choices.x,
                                          words_of(seeds, numbers, DIMENSION_LIGHT(depth)), &queued.lanes);
        uint next = surfaces & scatter(normal, make_frames16(normal), albedo, throughput, depth, choices.y,
                                       words_of(seeds, numbers, DIMENSION_BSDF(depth)), &queued.lanes);
        uint slot = next ? atomic_add(next_length, (uint)popcount(next)) : 0u;
        for (; next != 0; next &= next - 1, ++slot) {
            const uint k = lowest_bit(next);
            const Ray ray = {of->value[0][k], of->value[1][k], of->value[2][k], 0.0f,
                             of->value[3][k], of->value[4][k], of->value[5][k], INFINITY};
            const PathState state = {of->value[6][k], of->value[7][k], of->value[8][k], of->value[9][k], queued.path[k]};
            next_rays[slot] = ray, next_states[slot] = state;
        }
        slot = shadow ? atomic_add(shadow_length, (uint)popcount(shadow)) : 0u;
        for (; shadow != 0; shadow &= shadow - 1, ++slot) {
            const uint k = lowest_bit(shadow);
            const Ray ray = {of->value[0][k],  of->value[1][k],  of->value[2][k],  0.0f,
                             of->value[10][k], of->value[11][k], of->value[12][k], 1.0f};
            const LightSample sample = {of->value[13][k], of->value[14][k], of->value[15][k], queued.path[k]};
            shadow_rays[slot] = ray, shadow_light[slot] = sample;
        }
    }
}
