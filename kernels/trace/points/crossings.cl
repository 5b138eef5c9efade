// The triangles above each point: those that the ray from the point along +z meets. If their number is odd, the point is inside of
// a closed mesh.
//
// Along an axis everything can be decided exactly. In the plane z = 0 the signs of Kahan's determinants are exact, and a point on an
// edge or a vertex belongs to exactly one of the triangles there (tie_broken), so that each crossing counts once. Whether a triangle
// is above or below is the sign of a determinant of three rows. If float64 does not decide it, its 24 products are summed with twice
// the precision.
#include "trace/box.clh"
#include "trace/triangle.clh"

typedef struct Shape {
    float3 at;
} Shape;

static inline bool box_met(float3 lo, float3 hi, const Shape* s) {
    return lo.x <= s->at.x && hi.x >= s->at.x && lo.y <= s->at.y && hi.y >= s->at.y && hi.z >= s->at.z;
}
static inline uint boxes_met(global const WideNode* node, const Shape* s) {
    global const float8* rows = (global const float8*)node;
    return movemask8((rows[0] <= s->at.x) & (rows[1] >= s->at.x) & (rows[2] <= s->at.y) & (rows[3] >= s->at.y) &
                     (rows[5] >= s->at.z));
}

/// A sum in two parts.
typedef struct Sum2 {
    real high, low, size;
} Sum2;

/// Adds x * y * z, with an error of a few roundings of the low part (two products: Dekker 1971; sum: Knuth 1997, section 4.2.2).
static inline void add_product(Sum2* sum, real x, real y, real z) {
    const real xy = x * y, xy_rest = fma(x, y, -xy), xyz = xy * z, rest = fma(xy, z, -xyz) + xy_rest * z;
    const real total = sum->high + xyz, part = total - sum->high;
    sum->low += (sum->high - (total - part)) + (xyz - part) + rest;
    sum->high = total;
    sum->size += fabs(xyz);
}

/// The sign of det(a, b, c); 0 if it is 0 to within the doubled precision.
static CLARAY_NOINLINE real sign_of_determinant(Real3 a, Real3 b, Real3 c) {
    Sum2 sum = {0, 0, 0};
    add_product(&sum, a.x, b.y, c.z), add_product(&sum, -a.x, c.y, b.z);
    add_product(&sum, b.x, c.y, a.z), add_product(&sum, -b.x, a.y, c.z);
    add_product(&sum, c.x, a.y, b.z), add_product(&sum, -c.x, b.y, a.z);
    const real total = sum.high + sum.low;
    return fabs(total) > 64 * REAL_ROUNDOFF * REAL_ROUNDOFF * sum.size ? total : 0;
}

static inline Real3 seen_from(float3 v, float3 at) {
    const Real3 p = {(real)v.x - at.x, (real)v.y - at.y, (real)v.z - at.z};
    return p;
}

/// Whether the ray from the point along +z meets the triangle; not if it contains the point.
static inline bool triangle_met(float3 v0, float3 v1, float3 v2, const Shape* shape) {
    const Real3 a = seen_from(v0, shape->at), b = seen_from(v1, shape->at), c = seen_from(v2, shape->at);
    const real u = determinant(c.x, c.y, b.x, b.y), v = determinant(a.x, a.y, c.x, c.y), w = determinant(b.x, b.y, a.x, a.y);
    const real su = tie_broken(u, c, b), sv = tie_broken(v, a, c), sw = tie_broken(w, b, a);
    if ((su < 0 || sv < 0 || sw < 0) && (su > 0 || sv > 0 || sw > 0)) return false;
    const real det = u + v + w;
    if (det == 0) return false;
    const real ua = u * a.z, vb = v * b.z, wc = w * c.z;
    real height = ua + vb + wc;
    if (fabs(height) <= 8 * REAL_ROUNDOFF * (fabs(ua) + fabs(vb) + fabs(wc))) height = -sign_of_determinant(a, b, c);
    return height != 0 && (height > 0) == (det > 0);
}

#include "trace/overlaps/walk.clh"
#include "trace/query.clh"

/// Without `primitives` counts[i] is the number of triangles above point i; otherwise their indices are written to
/// primitives[offsets[i]] .. primitives[offsets[i + 1] - 1]. A split triangle counts once a part.
kernel QUERY_GROUP
void crossings(CLARAY_BVH_PARAMETERS, global const float* points, uint count, global const uint* offsets, global uint* primitives,
               global uint* counts) {
    FOR_EACH_RAY(i, count) {
        const Shape shape = {vload3(i, points)};
        Found found = found_of(primitives, offsets, i);
        if (isfinite(shape.at.z)) walk(CLARAY_BVH, &shape, &found);
        counts[i] = found.count;
    }
}

/// Rays from points in one direction.
kernel void rays_from_points(global const float* points, uint count, float x, float y, float z, global Ray* rays) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float3 at = vload3(i, points);
    const Ray ray = {at.x, at.y, at.z, 0.0f, x, y, z, INFINITY};
    rays[i] = ray;
}

/// Adds a vote where a ray crossed the surface an odd number of times.
kernel void add_votes(global const uint* counts, uint count, global uint* votes) {
    const uint i = get_global_id(0);
    if (i < count) votes[i] += counts[i] & 1u;
}

/// 1 where more than half of the votes are for inside, else 0.
kernel void decide_votes(global uint* votes, uint count, uint voters) {
    const uint i = get_global_id(0);
    if (i < count) votes[i] = 2 * votes[i] > voters ? 1 : 0;
}

/// 1 where a number is odd, else 0.
kernel void parities(global const uint* counts, uint count, global uchar* odd) {
    const uint i = get_global_id(0);
    if (i < count) odd[i] = counts[i] & 1u;
}

/// The distances with the sign of the side: negative inside.
kernel void sign_distances(global const NearestPoint* nearest, global const uint* counts, uint count, global float* distances) {
    const uint i = get_global_id(0);
    if (i < count) distances[i] = (counts[i] & 1u) != 0 ? -nearest[i].distance : nearest[i].distance;
}
