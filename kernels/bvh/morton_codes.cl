// A Morton code for every triangle's centroid, on the grid that bounds.cl laid.
#include "bvh/morton_codes.clh"
#include "bvh/triangles.clh"

/// Culled triangles get a code above all others, so that sorting puts them behind the tree's leaves.
kernel void compute_morton_codes(global const float* positions, global const uint* indices, uint count,
                                 global const BvhHeader* header, global Code* codes) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const Triangle triangle = load_triangle(positions, indices, i);
    if (!triangle_valid(triangle)) {
        codes[i] = ~(Code)0;
        return;
    }
    const Box box = box_of(triangle);
    const float3 offset = box.lo + box.hi - (float3)(header->lox, header->loy, header->loz);
    codes[i] = MORTON(grid_cell(offset.x, header->scale), grid_cell(offset.y, header->scale),
                      grid_cell(offset.z, header->scale));
}
