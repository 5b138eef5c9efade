// Two levels: instances place whole structures in the world. Shared by the host and all kernels.
#ifndef CLARAY_SHARED_INSTANCE_H
#define CLARAY_SHARED_INSTANCE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// One placement of a structure. The transform maps object space to world space: x' = row0 . (x, y, z, 1), and so on;
/// the last column is the translation. Transforms that are not finite, beyond 1e18 or not invertible in float32 are
/// counted and left out. Therefore a transform of zeros removes an instance from the scene.
typedef struct Instance {
    float row0[4], row1[4], row2[4];
    uint bottom;  // index of the structure, in the order given to the build
    uint mask;    // a ray sees the instance if its mask and this one share a bit
    uint id;      // free for the caller; claray does not change it
    uint tag;     // as id
} Instance;
CLARAY_LAYOUT(Instance, 64)

/// The data of an instance that a traversal reads: the rows of the inverse of the linear part, each followed by a
/// component of the translation. A point in object space is inverse * (x - translation).
typedef struct PlacedInstance {
    float row0[4], row1[4], row2[4];
    uint bottom;
    uint mask;
    uint id;
    uint moves;  // 1: the instance moves, and this is its placement at shutter open
} PlacedInstance;
CLARAY_LAYOUT(PlacedInstance, 64)

/// Where each structure begins, if several structures share one buffer.
typedef struct BottomRange {
    uint first_node;
    uint first_leaf;
} BottomRange;
CLARAY_LAYOUT(BottomRange, 8)

/// A hit and its instance. The distance is that of the ray in world space; u, v, primitive and geometry refer to the
/// structure of the instance.
typedef struct InstanceHit {
    float t;         // distance; the ray's tmax on a miss
    float u, v;      // barycentric weights of the second and the third vertex
    uint primitive;  // CLARAY_MISS on a miss
    uint geometry;
    uint instance;  // index in the order of the input; CLARAY_MISS on a miss
} InstanceHit;
CLARAY_LAYOUT(InstanceHit, 24)

CLARAY_SHARED_END

#endif
