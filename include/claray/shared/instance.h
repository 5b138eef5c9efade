// Two levels: instances place whole structures in the world, as the host and every kernel see them.
#ifndef CLARAY_SHARED_INSTANCE_H
#define CLARAY_SHARED_INSTANCE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// One placement of a structure. The transform maps objects into the world: x' = row0 . (x, y, z, 1), and so on; its
/// last column is the translation. Transforms that are not finite, beyond 1e18 or without an inverse in float32 are
/// counted and left out, so that a transform of zeros takes an instance out of the scene.
typedef struct Instance {
    float row0[4], row1[4], row2[4];
    uint bottom;  // index of the structure, in the order in which they were given
    uint mask;    // a ray sees the instance where its mask and this one share a bit
    uint id;      // the caller's own; claray only keeps it
    uint tag;     // another of the caller's
} Instance;
CLARAY_LAYOUT(Instance, 64)

/// What a traversal needs of an instance: rows of the inverse of the linear part, each with a component of the
/// translation behind it. An object's point is inverse * (x - translation).
typedef struct PlacedInstance {
    float row0[4], row1[4], row2[4];
    uint bottom;
    uint mask;
    uint id;
    uint moves;  // 1: all this is as the shutter opens only
} PlacedInstance;
CLARAY_LAYOUT(PlacedInstance, 64)

/// Where one of several structures begins in the memory that holds them all.
typedef struct BottomRange {
    uint first_node;
    uint first_leaf;
} BottomRange;
CLARAY_LAYOUT(BottomRange, 8)

/// A hit, and of which instance. The distance is that of the world's ray; u, v, primitive and geometry are as the
/// instance's own structure counts them.
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
