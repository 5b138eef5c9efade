// Determines whether neighbouring rays of an array have similar directions, to choose a schedule of ray_queue.clh.
#include "trace/ray.clh"
#include "trace/query.clh"

/// One group with one sample per item, because everything else waits for it. Compares rays of one warp, 16 apart, throughout the
/// array. queue[2] becomes 1 if three quarters of the pairs agree in direction to within about 25 degrees.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void sample_coherence(global const Ray* rays, uint capacity, global const uint* count, global uint* queue) {
    local uint alike;
    if (get_local_id(0) == 0) alike = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint all = rays_to_trace(capacity, count);
    if (all != 0) {
        const uint i = min((uint)((ulong)all * get_local_id(0) / GROUP_SIZE), all < 17 ? 0 : all - 17), j = min(i + 16, all - 1);
        const float3 a = (float3)(rays[i].dx, rays[i].dy, rays[i].dz), b = (float3)(rays[j].dx, rays[j].dy, rays[j].dz);
        const float along = dot(a, b);
        if (along > 0.0f && along * along > 0.8f * dot(a, a) * dot(b, b)) atomic_inc(&alike);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) queue[2] = alike * 4 >= GROUP_SIZE * 3;
}
