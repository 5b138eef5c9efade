// Which rays of an array stand for all.
#ifndef CLARAY_SHARED_RAY_SAMPLES_H
#define CLARAY_SHARED_RAY_SAMPLES_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// The place of a sample among `count` rays, or 0: multiples of the golden ratio. Places at equal distances can all be
/// the ends of an image's rows, where a ray is unlike the next one.
CLARAY_SHARED_FUNCTION uint place_of_sample(uint sample, uint count) {
    return (uint)((ulong)count * (sample * 0x9e3779b9u) >> 32);
}

CLARAY_SHARED_END

#endif
