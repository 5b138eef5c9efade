// Bounds and Morton codes for CPUs, with the results of bounds.cl and morton_codes.cl. Centroids are computed once, one triangle at
// a time, and encoded by vectors. finish_bounds of bounds.cl lays the grid in between.
#include "bvh/morton_codes.clh"
#include "bvh/serial/serial.clh"

/// As triangle_valid. The fourth lanes are 0.
static inline bool vertices_valid(float4 v0, float4 v1, float4 v2) {
    const int4 small = (fabs(v0) <= COORDINATE_LIMIT) & (fabs(v1) <= COORDINATE_LIMIT) & (fabs(v2) <= COORDINATE_LIMIT);
    return movemask4(small) == 15 && movemask4(v0 == v1) != 15 && movemask4(v1 == v2) != 15 && movemask4(v2 == v0) != 15;
}

/// One item per range of triangles. `centroids` receives all x, then all y, then all z; x is NaN for triangles that are not
/// valid. Adds bounds and valid triangles to `keys` and the header as compute_bounds.
kernel void compute_centroids(global const float* positions, global const uint* indices, uint count,
                              global BvhHeader* header, volatile global uint* keys, uint ranges,
                              global float* centroids) {
    const uint range = get_global_id(0);
    if (range >= ranges) return;
    float4 lo = (float4)(MAXFLOAT), hi = (float4)(-MAXFLOAT);
    uint valid = 0;
    const uint end = range_begin(range + 1, ranges, count);
    for (uint i = range_begin(range, ranges, count); i < end; ++i) {
        const Triangle t = load_triangle(positions, indices, i);
        const float4 v0 = (float4)(t.v0, 0.0f), v1 = (float4)(t.v1, 0.0f), v2 = (float4)(t.v2, 0.0f);
        if (!vertices_valid(v0, v1, v2)) {
            centroids[i] = NAN;
            continue;
        }
        const float4 centroid = lesser(lesser(v0, v1), v2) + greater(greater(v0, v1), v2);  // mutant: centroid-extremes
        centroids[i] = centroid.x, centroids[(size_t)count + i] = centroid.y, centroids[2 * (size_t)count + i] = centroid.z;
        lo = lesser(lo, centroid), hi = greater(hi, centroid);
        ++valid;
    }
    if (valid == 0) return;
    atomic_min(&keys[0], float_key(lo.x)), atomic_max(&keys[3], float_key(hi.x));
    atomic_min(&keys[1], float_key(lo.y)), atomic_max(&keys[4], float_key(hi.y));
    atomic_min(&keys[2], float_key(lo.z)), atomic_max(&keys[5], float_key(hi.z));
    atomic_add(&header->valid, valid);
}

/// One item per range of triangles. The loop has no branches, so that compilers can vectorise it.
kernel void encode_centroids(global const float* restrict centroids, uint count, global const BvhHeader* header,
                             global const uint* restrict keys, uint ranges, global Code* restrict codes) {
    const uint range = get_global_id(0);
    if (range >= ranges) return;
    const float lox = header->lox, loy = header->loy, loz = header->loz;
    const float scale = as_float(keys[GRID_SCALE]);
    global const float* restrict xs = centroids;
    global const float* restrict ys = centroids + count;
    global const float* restrict zs = centroids + 2 * (size_t)count;
    const uint end = range_begin(range + 1, ranges, count);
    for (uint i = range_begin(range, ranges, count); i < end; ++i) {
        const float x = xs[i];
        const bool valid = x == x;
        const Code code = MORTON(grid_cell(valid ? x - lox : 0.0f, scale), grid_cell(valid ? ys[i] - loy : 0.0f, scale),
                                 grid_cell(valid ? zs[i] - loz : 0.0f, scale));
        codes[i] = valid ? code : ~(Code)0;
    }
}
