// The builder takes triangles; an instance enters it as one that spans its box, so that codes, sort, hierarchy, refit and
// validation are those of every other structure.
#include "bvh/instances/placement.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

/// `widening`, zero before, becomes the largest of all instances; of positive floats the bits have the same order. `ends` is
/// absent where nothing moves.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void place_instances(global const Instance* instances, global const Instance* ends, uint count, global const BvhHeader* bottoms,
                     uint bottom_count, global PlacedInstance* placed, global float* corners, volatile global uint* widening) {
    local uint group_widening;
    if (get_local_id(0) == 0) group_widening = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const size_t i = get_global_id(0);
    if (i < count) {
        const float mine = place_instance(&instances[i], ends ? &ends[i] : 0, bottoms, bottom_count, &placed[i], corners + 9 * i);
        atomic_max(&group_widening, as_uint(mine));
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) atomic_max(widening, group_widening);
}

/// Corner i of the boxes is vertex i.
kernel void number_corners(global uint* indices, uint count) {
    const uint i = get_global_id(0);
    if (i < count) indices[i] = i;
}
