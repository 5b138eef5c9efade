// Input and output of queries, shared by the host and all kernels.
#ifndef CLARAY_SHARED_TYPES_H
#define CLARAY_SHARED_TYPES_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// A ray hits at distances tmin < t <= tmax, in units of the direction's length. The direction need not be normalized.
/// tmin must not be negative. A ray that passes exactly through an edge or a vertex hits exactly one of the triangles
/// that share it. The border of an open mesh is half open, as in rasterization.
typedef struct Ray {
    float ox, oy, oz;  // origin
    float tmin;
    float dx, dy, dz;  // direction
    float tmax;
} Ray;
CLARAY_LAYOUT(Ray, 32)

/// Hit::primitive of a ray that hits nothing.
#define CLARAY_MISS 0xffffffffu

/// A hit. The hit point is (1 - u - v) * v0 + u * v1 + v * v2 of the triangle.
typedef struct Hit {
    float t;         // distance; the ray's tmax on a miss
    float u, v;      // barycentric weights of the second and the third vertex
    uint primitive;  // index of the triangle in the input, over all geometries; CLARAY_MISS on a miss
    uint geometry;   // index of its mesh
} Hit;
CLARAY_LAYOUT(Hit, 20)

/// The point of a surface that is nearest to another point.
typedef struct NearestPoint {
    float x, y, z;   // the nearest point; the query's own point on a miss
    float distance;  // the query's largest distance on a miss
    float u, v;      // barycentric weights of the second and the third vertex
    uint primitive;  // index of the triangle in the input, over all geometries; CLARAY_MISS if there is none in reach
    uint geometry;   // index of its mesh
} NearestPoint;
CLARAY_LAYOUT(NearestPoint, 32)

/// The cost of one query: number of boxes and of triangles tested.
typedef struct Visits {
    uint nodes;
    uint triangles;
} Visits;
CLARAY_LAYOUT(Visits, 8)

CLARAY_SHARED_END

#endif
