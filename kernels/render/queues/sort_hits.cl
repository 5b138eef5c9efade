// The stage between trace and shade_surface where kinds of materials have kernels of their own: lists the rays for each kernel.
#include "render/queue.clh"
#include "shade/surface_at_hit.clh"

/// Appends the number of each ray of the queue to the list of the shader of the material that it met; misses go to the first. `sorted` has
/// `room` numbers for each shader. Empties the lists of the next depth.
kernel __attribute__((reqd_work_group_size(64, 1, 1)))
void sort_hits(Step step, SCENE_PARAMETERS, global QueueLength* lengths, global const SceneHit* hits, global uint* sorted) {
    local uint counts[CLARAY_MOST_SHADERS], begins[CLARAY_MOST_SHADERS];
    const FrameData* frame = &step.frame;
    const uint i = get_global_id(0), item = get_local_id(0), all = min(*length_of_rays(lengths, step.depth), step.capacity);
    if (i < CLARAY_MOST_SHADERS) *length_of_shader(lengths, step.depth + 1u, i) = 0u;
    if (item < CLARAY_MOST_SHADERS) counts[item] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint shader = 0u, rank = 0u;
    if (i < all) {
        const Hit hit = hit_of(hits[i] INSTANCE_BUFFERS);
        if (hit.primitive != CLARAY_MISS) shader = plain_material_at(frame, tables, hit)->shader;
        rank = atomic_inc(&counts[shader]);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < CLARAY_MOST_SHADERS && counts[item] != 0u)
        begins[item] = atomic_add(length_of_shader(lengths, step.depth, item), counts[item]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < all) sorted[shader * (size_t)step.room + begins[shader] + rank] = i;
}
