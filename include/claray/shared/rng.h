// Random and low-discrepancy numbers, the same on host and device.
//
// Samples are points of the two-dimensional Sobol sequence (Sobol 1967) under hash-based Owen scrambling: Laine and
// Karras 2011, "Stratified sampling for stochastic transparency"; Burley 2020, "Practical hash-based Owen scrambling"
// (JCGT 9:4). Higher dimensions are pairs of their own, each with its own shuffle of the indices ("padding", Burley
// section 6).
#ifndef CLARAY_SHARED_RNG_H
#define CLARAY_SHARED_RNG_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// Two numbers of 32 bits, uniform in 0 .. 2^32 - 1.
typedef struct SamplePair {
    uint x, y;
} SamplePair;
CLARAY_LAYOUT(SamplePair, 8)

#define CLARAY_SOBOL 0
#define CLARAY_INDEPENDENT 1

/// A bijection of 32-bit words whose output bits all depend on all input bits (constants: Wellons 2018, "lowbias32").
CLARAY_SHARED_FUNCTION uint hash_word(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

CLARAY_SHARED_FUNCTION uint hash_words(uint a, uint b) {
    return hash_word(a ^ (hash_word(b + 0x9e3779b9u) * 0x85ebca6bu));
}

CLARAY_SHARED_FUNCTION uint reverse_bits(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/// Owen scrambling of a number whose bits are in reverse: every bit is flipped or not by a hash of the bits below it.
/// The constants are Vegdahl's (2021, "Building a better LK hash").
CLARAY_SHARED_FUNCTION uint owen_scramble_reversed(uint x, uint seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

/// Bits of the second Sobol dimension in reverse. Its generator matrix is Pascal's triangle modulo 2, the fifth
/// Kronecker power of (1 1; 0 1), hence these five steps instead of a loop over 32 direction numbers.
CLARAY_SHARED_FUNCTION uint sobol_second_reversed(uint index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    return index ^ (index >> 16);
}

/// Point `index` of a shuffled and scrambled Sobol sequence; seeds give independent sequences.
CLARAY_SHARED_FUNCTION SamplePair sobol_pair(uint index, uint seed) {
    SamplePair pair;
    index = reverse_bits(owen_scramble_reversed(reverse_bits(index), seed));
    pair.x = reverse_bits(owen_scramble_reversed(index, hash_word(seed ^ 0x68bc21ebu)));
    pair.y = reverse_bits(owen_scramble_reversed(sobol_second_reversed(index), hash_word(seed ^ 0x02e5be93u)));
    return pair;
}

/// Independent numbers from a counter (pcg2d of Jarzynski and Olano 2020, "Hash functions for GPU rendering").
CLARAY_SHARED_FUNCTION SamplePair independent_pair(uint index, uint seed) {
    SamplePair pair;
    pair.x = index * 1664525u + 1013904223u;
    pair.y = seed * 1664525u + 1013904223u;
    pair.x += pair.y * 1664525u;
    pair.y += pair.x * 1664525u;
    pair.x ^= pair.x >> 16;
    pair.y ^= pair.y >> 16;
    pair.x += pair.y * 1664525u;
    pair.y += pair.x * 1664525u;
    pair.x ^= pair.x >> 16;
    pair.y ^= pair.y >> 16;
    return pair;
}

/// The pair of numbers that sample `sample` of a pixel uses for `dimension`. Samples alternate between two sequences
/// that are scrambled independently, so that the difference of their means tells the error of both (Owen 1997:
/// replicated randomised quasi-Monte Carlo).
CLARAY_SHARED_FUNCTION SamplePair sample_pair(uint sampler, uint pixel_seed, uint sample, uint dimension) {
    const uint seed = hash_words(pixel_seed ^ (sample & 1u), dimension);
    return sampler == CLARAY_SOBOL ? sobol_pair(sample >> 1, seed) : independent_pair(sample, seed);
}

/// Uniform in [0, 1): the upper 24 bits, exactly.
CLARAY_SHARED_FUNCTION float unit_float(uint word) { return (float)(word >> 8) * 5.9604644775390625e-8f; }

CLARAY_SHARED_END

#endif
