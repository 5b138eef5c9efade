// Prepares instances for the builder: each becomes a triangle that spans its box, so that codes, sort, hierarchy, refit and
// validation are shared with other structures.
#include "bvh/instances/placement.clh"

#ifndef GROUP_SIZE
#define GROUP_SIZE 64
#endif

/// `widening`, zero before, becomes the maximum of all instances; the bits of positive floats have the floats' order. `ends` and
/// `moving` are absent if nothing moves.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void place_instances(global const Instance* instances, global const Instance* ends, uint count, global const BvhHeader* bottoms,
                     uint bottom_count, global PlacedInstance* placed, global MovingInstance* moving, global float* corners,
                     volatile global uint* widening) {
    local uint group_widening;
    if (get_local_id(0) == 0) group_widening = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const size_t i = get_global_id(0);
    if (i < count) {
        const float mine = place_instance(&instances[i], ends ? &ends[i] : 0, bottoms, bottom_count, &placed[i], corners + 9 * i);
        atomic_max(&group_widening, as_uint(mine));
        if (ends) moving[i].begin = instances[i], moving[i].end = ends[i];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) atomic_max(widening, group_widening);
}

/// Makes corner i of the boxes vertex i.
kernel void number_corners(global uint* indices, uint count) {
    const uint i = get_global_id(0);
    if (i < count) indices[i] = i;
}
