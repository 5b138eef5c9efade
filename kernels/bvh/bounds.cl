// Bounds of the centroids of all valid triangles, and the Morton grid over them. A centroid is here the doubled centre of the
// triangle's box; doubling avoids a rounding.
#include "bvh/triangles.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 256
#endif

/// First kernel of every build.
kernel void reset_header(global BvhHeader* header, global uint* keys) {
    if (get_global_id(0) != 0) return;
    const float largest = MAXFLOAT;
    header->lox = header->loy = header->loz = largest;
    header->hix = header->hiy = header->hiz = -largest;
    header->root = CLARAY_NO_CHILD;
    header->valid = header->culled = header->height = header->wide_nodes = header->wide_blocks = 0;
    header->widening = 0.0f;
    header->inner_nodes = header->first_node = header->first_leaf = 0;
    keys[GRID_SCALE] = 0;
    for (uint axis = 0; axis < 3; ++axis) keys[axis] = 0xffffffffu, keys[3 + axis] = 0;
}

static inline float group_min(float value, local float* scratch) {
    const uint item = get_local_id(0);
    scratch[item] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
        if (item < half_size) scratch[item] = fmin(scratch[item], scratch[item + half_size]);
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    const float least = scratch[0];
    barrier(CLK_LOCAL_MEM_FENCE);
    return least;
}

/// Adds the centroids to `keys`: minima, then maxima, as order-preserving integers (float_key); counts valid triangles.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void compute_bounds(global const float* positions, global const uint* indices, uint count, global BvhHeader* header,
                    volatile global uint* keys) {
    local float scratch[GROUP_SIZE];
    local uint group_valid;
    if (get_local_id(0) == 0) group_valid = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    float3 lo = (float3)(MAXFLOAT), hi = (float3)(-MAXFLOAT);
    uint valid = 0;
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        const Triangle triangle = load_triangle(positions, indices, i);
        if (!triangle_valid(triangle)) continue;
        const Box box = box_of(triangle);
        const float3 centroid = box.lo + box.hi;
        lo = fmin(lo, centroid), hi = fmax(hi, centroid);
        ++valid;
    }
    atomic_add(&group_valid, valid);
    const float least[6] = {lo.x, lo.y, lo.z, -hi.x, -hi.y, -hi.z};
    for (uint i = 0; i < 6; ++i) {
        const float group_least = group_min(least[i], scratch);
        if (get_local_id(0) != 0) continue;
        if (i < 3) atomic_min(&keys[i], float_key(group_least));
        else atomic_max(&keys[i], float_key(-group_least));
    }
    if (get_local_id(0) == 0 && group_valid != 0) atomic_add(&header->valid, group_valid);
}

/// The largest scale of 9 significant bits with extent * scale <= cells. Uses only products and comparisons, which all devices
/// round alike: a division could differ in its last bit and give another tree.
static inline float grid_scale(float extent, float cells) {
    if (!(extent > 0.0f)) return 0.0f;
    float scale = 1.0f;
    while (extent * scale > cells) scale *= 0.5f;
    while (extent * scale * 2.0f <= cells && scale < 1e30f) scale *= 2.0f;
    float step = scale;
    for (int bit = 0; bit < 8; ++bit) {
        step *= 0.5f;
        if (extent * (scale + step) <= cells) scale += step;
    }
    return scale;
}

/// Lays a grid of cubic cells over the centroids, 2^axis_bits along the longest axis. Its origin goes to the header, its scale to
/// `keys`. Cells are cubes, because with equally many cells along each axis flat scenes would be split as often across as along
/// (terrain: SAH cost 59.4 instead of 53.6).
kernel void finish_bounds(global BvhHeader* header, global uint* keys, uint count, uint axis_bits) {
    if (get_global_id(0) != 0) return;
    header->inner_nodes = max(header->valid, 1u) - 1;
    header->culled = count - header->valid;
    if (header->valid == 0) return;
    const float cells = (float)(1u << axis_bits);
    const float lox = float_from_key(keys[0]), loy = float_from_key(keys[1]), loz = float_from_key(keys[2]);
    header->lox = lox, header->loy = loy, header->loz = loz;
    const float extent =
        max(max(float_from_key(keys[3]) - lox, float_from_key(keys[4]) - loy), float_from_key(keys[5]) - loz);
    keys[GRID_SCALE] = as_uint(grid_scale(extent, cells));  // mutant: grid-cubes
}
