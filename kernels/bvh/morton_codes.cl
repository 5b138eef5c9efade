// Computes the Morton code of each triangle's centroid on the grid of bounds.cl.
#include "bvh/morton_codes.clh"
#include "bvh/triangles.clh"

/// Culled triangles get a code above all others, so that they are sorted after the leaves of the tree.
kernel void compute_morton_codes(global const float* positions, global const uint* indices, uint count,
                                 global const BvhHeader* header, global const uint* keys, global Code* codes) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const Triangle triangle = load_triangle(positions, indices, i);
    if (!triangle_valid(triangle)) {
        codes[i] = ~(Code)0;
        return;
    }
    const Box box = box_of(triangle);
    const float3 offset = box.lo + box.hi - (float3)(header->lox, header->loy, header->loz);
    const float scale = as_float(keys[GRID_SCALE]);
    codes[i] = MORTON(grid_cell(offset.x, scale), grid_cell(offset.y, scale), grid_cell(offset.z, scale));
}
