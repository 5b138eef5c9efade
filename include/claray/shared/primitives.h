// Primitives of a scene: geometry that is not triangles. Shared by the host and the kernels that shade.
#ifndef CLARAY_SHARED_PRIMITIVES_H
#define CLARAY_SHARED_PRIMITIVES_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

// The kinds of claray::PrimitiveSet. Kernels are compiled for a set of them: bits of the macro PRIMITIVES.
#define CLARAY_SPHERES 0u
#define CLARAY_DISCS 1u
#define CLARAY_CYLINDERS 2u
#define CLARAY_CURVES 3u
#define CLARAY_BEZIER_CURVES 4u
#define CLARAY_PRIMITIVE_KINDS 5u

/// The beginning of the buffer that holds the primitives of a scene. Their numbers in hits follow those of the
/// triangles, kind after kind.
typedef struct PrimitiveStore {
    uint first[6];  // number of the first primitive of each kind, and one more than the last number
    uint data[5];   // the word where the data of each kind begins, in the form of kernels/primitives
    uint colors;    // the word where the colours begin, 0: none. Six floats per primitive: RGB at u = 0 and at u = 1
} PrimitiveStore;
CLARAY_LAYOUT(PrimitiveStore, 48)

CLARAY_SHARED_END

#endif
