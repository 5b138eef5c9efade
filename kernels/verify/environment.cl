// Sampled directions of an environment image, and the claimed density of directions.
#include "claray/shared/rng.h"
#include "lights/environment.clh"

/// Four numbers per sample: the direction and its density.
kernel void sample_environment(EnvironmentData image, global const float* texels, global const float* cdf, uint count, uint seed,
                               global float* samples) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const SamplePair a = independent_pair(i, hash_word(seed));
    LightView view;
    view_environment(image, texels, cdf, (float2)(unit_float(a.x), unit_float(a.y)), &view);
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
