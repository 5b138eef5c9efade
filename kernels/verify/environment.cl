// Sampled directions of an environment image, and the claimed density of directions.
#include "claray/shared/rng.h"
#include "lights/environment.clh"

/// A seed that gives pairs of numbers at the ends of [0, 1) and between.
#define EXTREME_NUMBERS 0xffffffffu

static inline float extreme_number(uint i) {
    return (i & 2u) ? (i & 1u ? 0.99999994f : 0.33333334f) : (i & 1u ? 5.9604645e-8f : 0.0f);
}

/// Four numbers per sample: the direction and its density.
kernel void sample_environment(EnvironmentData image, global const float* texels, global const float* cdf, uint count, uint seed,
                               global float* samples) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const SamplePair a = independent_pair(i, hash_word(seed));
    LightView view;
    const float2 drawn = seed == EXTREME_NUMBERS ? (float2)(extreme_number(i), extreme_number(i >> 2))
                                                 : (float2)(unit_float(a.x), unit_float(a.y));
    view_environment(image, texels, cdf, drawn, &view);
    vstore4((float4)(view.direction, view.pdf), i, samples);
}

/// The density of each direction (three numbers).
kernel void density_of_environment(EnvironmentData image, global const float* texels, uint count, global const float* directions,
                                   global float* densities) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    float pdf;
    environment_radiance(image, texels, environment_place(image, vload3(i, directions)), &pdf);
    densities[i] = pdf;
}
