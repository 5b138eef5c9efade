// The triangles that overlap boxes: by the separating axes of box and triangle (Akenine-Moeller 2001, "Fast 3D triangle-box
// overlap testing"), in float64. Shapes that touch overlap.
#include "trace/box.clh"

typedef struct Shape {
    float3 lo, hi;
} Shape;

static inline bool box_met(float3 lo, float3 hi, const Shape* s) {
    return lo.x <= s->hi.x && hi.x >= s->lo.x && lo.y <= s->hi.y && hi.y >= s->lo.y && lo.z <= s->hi.z && hi.z >= s->lo.z;
}
static inline uint boxes_met(global const WideNode* node, const Shape* s) {
    global const float8* rows = (global const float8*)node;
    return movemask8((rows[0] <= s->hi.x) & (rows[1] >= s->lo.x) & (rows[2] <= s->hi.y) & (rows[3] >= s->lo.y) &
                     (rows[4] <= s->hi.z) & (rows[5] >= s->lo.z));
}

/// Whether the projections of two points of the triangle and of the box onto an axis in a coordinate plane overlap. (x, y) is an
/// edge; the axis is (-y, x). The third vertex projects between the points or onto one of them.
static inline bool along_edge(real x, real y, real px, real py, real qx, real qy, real hx, real hy) {
    const real p = determinant(x, y, px, py), q = determinant(x, y, qx, qy), reach = hx * fabs(y) + hy * fabs(x);
    return fmin(p, q) <= reach && fmax(p, q) >= -reach;
}

/// The axes of an edge from a to b with each coordinate axis; c is the third vertex.
static inline bool along_edges(const real* a, const real* b, const real* c, const real* half_side) {
    for (uint i = 0; i < 3; ++i) {
        const uint j = i == 2 ? 0 : i + 1, k = j == 2 ? 0 : j + 1;
        if (!along_edge(b[j] - a[j], b[k] - a[k], a[j], a[k], c[j], c[k], half_side[j], half_side[k])) return false;
    }
    return true;
}

static inline bool triangle_met(float3 v0, float3 v1, float3 v2, const Shape* shape) {
    if (!box_met(fmin(fmin(v0, v1), v2), fmax(fmax(v0, v1), v2), shape)) return false;
    const float lo[3] = {shape->lo.x, shape->lo.y, shape->lo.z}, hi[3] = {shape->hi.x, shape->hi.y, shape->hi.z};
    const float p0[3] = {v0.x, v0.y, v0.z}, p1[3] = {v1.x, v1.y, v1.z}, p2[3] = {v2.x, v2.y, v2.z};
    real a[3], b[3], c[3], half_side[3];
    for (uint i = 0; i < 3; ++i) {
        const real middle = ((real)lo[i] + hi[i]) / 2;
        half_side[i] = ((real)hi[i] - lo[i]) / 2;
        a[i] = p0[i] - middle, b[i] = p1[i] - middle, c[i] = p2[i] - middle;
    }
    if (!along_edges(a, b, c, half_side) || !along_edges(b, c, a, half_side) || !along_edges(c, a, b, half_side)) return false;
    real height = 0, reach = 0;  // of the plane from the box's centre, and of the box along the normal
    for (uint i = 0; i < 3; ++i) {
        const uint j = i == 2 ? 0 : i + 1, k = j == 2 ? 0 : j + 1;
        const real normal = determinant(b[j] - a[j], b[k] - a[k], c[j] - a[j], c[k] - a[k]);
        height += normal * a[i];
        reach += fabs(normal) * half_side[i];
    }
    return fabs(height) <= reach;
}

#include "trace/overlaps/walk.clh"
#include "trace/query.clh"

/// Box i is from (shapes[6 i], ...) to (shapes[6 i + 3], ...). Without `primitives` counts[i] is the number of triangles that overlap
/// it; otherwise their indices are written to primitives[offsets[i]] .. primitives[offsets[i + 1] - 1]. A split triangle counts once
/// a part.
kernel QUERY_GROUP
void overlap_boxes(CLARAY_BVH_PARAMETERS, global const float* shapes, uint count, global const uint* offsets,
                   global uint* primitives, global uint* counts) {
    FOR_EACH_RAY(i, count) {
        const Shape shape = {vload3(2 * i, shapes), vload3(2 * i + 1, shapes)};
        Found found = found_of(primitives, offsets, i);
        if (shape.lo.x <= shape.hi.x && shape.lo.y <= shape.hi.y && shape.lo.z <= shape.hi.z) walk(CLARAY_BVH, &shape, &found);
        counts[i] = found.count;
    }
}
