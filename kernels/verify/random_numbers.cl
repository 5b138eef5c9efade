// Random numbers as paths draw them, and steps down a tree of lights, which divide them.
#include "math/rng_four.clh"
#include "render/samples.clh"
#include "lanes/one.clh"
#include "math/vector.clh"
#include "lights/lanes/tree_lanes.clh"
#include "lanes/four.clh"
#include "lights/lanes/tree_lanes.clh"

/// Both numbers of one sample after the other, in three dimensions: `words`, and the floats that are made of them.
kernel void draw_numbers(uint pixel_seed, uint count, global uint* words, global float* floats) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const PathSamples samples = {pixel_seed, i};
    const SurfaceSamples at = samples_at(samples, 1u);
    const SamplePair pairs[3] = {draw_words(samples, DIMENSION_FILM), words_at(&at, AT_CHOICE), words_at(&at, AT_LOBE)};
    for (uint k = 0; k < 3; ++k) {
        const float2 both = floats_of(pairs[k]);
        words[6 * i + 2 * k] = pairs[k].x, words[6 * i + 2 * k + 1] = pairs[k].y;
        floats[6 * i + 2 * k] = both.x, floats[6 * i + 2 * k + 1] = both.y;
    }
}

/// `levels` steps of four descents each, by one ray and by four: `shares` holds the weights of four children for each level. Writes
/// child, across, down and probability after each step, as words; those of the four behind those of the single ones.
kernel void descend(uint count, uint levels, global const float* shares, global const uint* words, global uint* out) {
    const uint i = get_global_id(0), room = 16u * levels;
    if (i >= count) return;
    const uint4 xs = vload4(2u * i, words), ys = vload4(2u * i + 1u, words);
    const uint x[4] = {xs.x, xs.y, xs.z, xs.w}, y[4] = {ys.x, ys.y, ys.z, ys.w};
    global uint* single = out + 2u * room * i;
    for (uint k = 0; k < 4u; ++k) {
        Descent place = {unit_float(x[k]), unit_float(y[k]), 1.0f, x[k], 0};
        for (uint level = 0; level < levels; ++level) {
            const float4 of = vload4(level, shares);
            choose_child(of.x, of.y, of.z, of.w, &place);
            vstore4((uint4)((uint)place.child, as_uint(place.across), as_uint(place.down), as_uint(place.probability)),
                    4u * level + k, single);
        }
    }
    global uint* joint = single + room;
    Descent4 places = {unit_float4(xs), unit_float4(ys), (float4)(1.0f), xs, (int4)(0)};
    for (uint level = 0; level < levels; ++level) {
        const float4 of = vload4(level, shares);
        choose_child4((float4)(of.x), (float4)(of.y), (float4)(of.z), (float4)(of.w), &places);
        const uint4 child = as_uint4(places.child), across = as_uint4(places.across), down = as_uint4(places.down),
                    probability = as_uint4(places.probability);
        vstore4((uint4)(child.x, across.x, down.x, probability.x), 4u * level, joint);
        vstore4((uint4)(child.y, across.y, down.y, probability.y), 4u * level + 1u, joint);
        vstore4((uint4)(child.z, across.z, down.z, probability.z), 4u * level + 2u, joint);
        vstore4((uint4)(child.w, across.w, down.w, probability.w), 4u * level + 3u, joint);
    }
}
