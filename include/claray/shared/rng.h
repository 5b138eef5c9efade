// Random and low-discrepancy numbers, equal on host and device.
//
// Samples are points of the two-dimensional Sobol sequence (Sobol 1967) with hash-based Owen scrambling: Laine and
// Karras 2011, "Stratified sampling for stochastic transparency". Burley 2020, "Practical hash-based Owen scrambling"
// (JCGT 9:4). Higher dimensions are separate pairs, each with a different shuffle of the indices ("padding", Burley
// section 6).
#ifndef CLARAY_SHARED_RNG_H
#define CLARAY_SHARED_RNG_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// Two 32-bit numbers, uniform in 0 .. 2^32 - 1.
typedef struct SamplePair {
    uint x, y;
} SamplePair;
CLARAY_LAYOUT(SamplePair, 8)

#define CLARAY_SOBOL 0
#define CLARAY_INDEPENDENT 1

#define CLARAY_WORD uint
#define CLARAY_PAIR SamplePair
#define CLARAY_OF_WORD(name) name
#include "claray/shared/rng_words.h"
#undef CLARAY_WORD
#undef CLARAY_PAIR
#undef CLARAY_OF_WORD

/// Uniform in [0, 1): the upper 24 bits, without rounding.
CLARAY_SHARED_FUNCTION float unit_float(uint word) {
    return (float)(word >> 8) * 5.9604644775390625e-8f;  // mutant: unit-interval
}

CLARAY_SHARED_END

#endif
