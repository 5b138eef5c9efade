// The triangles that overlap solid spheres: those whose nearest point is not farther from the centre than the radius.
#include "trace/points/distance.clh"

typedef struct Shape {
    float3 center;
    float radius, bound;  // see square_bound
} Shape;

static inline bool box_met(float3 lo, float3 hi, const Shape* s) { return square_to_box(s->center, lo, hi) <= s->bound; }
static inline uint boxes_met(global const WideNode* node, const Shape* s) {
    float8 squares;
    return boxes_near(node, s->center, s->bound, &squares);
}

static inline bool triangle_met(float3 v0, float3 v1, float3 v2, const Shape* s) {
    const real x = s->center.x, y = s->center.y, z = s->center.z;
    return nearest_on_triangle(v0.x - x, v0.y - y, v0.z - z, v1.x - x, v1.y - y, v1.z - z, v2.x - x, v2.y - y, v2.z - z).d2 <=
           (real)s->radius * s->radius;
}

#include "trace/overlaps/walk.clh"
#include "trace/query.clh"

/// Sphere i has the centre (shapes[4 i], ...) and the radius shapes[4 i + 3]. The rest as overlap_boxes.
kernel QUERY_GROUP
void overlap_spheres(CLARAY_BVH_PARAMETERS, global const float* shapes, uint count, global const uint* offsets,
                     global uint* primitives, global uint* counts) {
    FOR_EACH_RAY(i, count) {
        const float4 s = vload4(i, shapes);
        const Shape shape = {s.xyz, s.w, square_bound(s.w)};
        Found found = found_of(primitives, offsets, i);
        const float sum = s.x * 0.0f + s.y * 0.0f + s.z * 0.0f;  // NaN if any is not finite
        if (sum == 0.0f && s.w >= 0.0f) walk(CLARAY_BVH, &shape, &found);
        counts[i] = found.count;
    }
}
