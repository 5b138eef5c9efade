// Adds what the paths of a batch found to the bins of the path guide.
#define PATH_GUIDE 1
#include "render/guiding/path_guide.clh"

/// Not every device adds 64 bits at once: whoever makes the lower half overflow carries.
static inline void add_to_sum(volatile global uint* halves, ulong value) {
    const uint low = (uint)value, before = atomic_add(&halves[0], low);
    const uint high = (uint)(value >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0u) atomic_add(&halves[1], high);
}

/// For each path: the light that came from the directions in which its first surfaces sent it.
kernel void learn_light(Step step, global const float* radiance, global GuideBin* bins) {
    const uint path = get_global_id(0);
    if (path >= step.batch.pixels * step.batch.samples) return;
    const float all = brightness_of(vload3(path, radiance)) * step.frame.guide.unit;
    for (uint k = 0; k < CLARAY_GUIDE_LESSONS; ++k) {
        const float3 lesson = vload3(0, radiance + place_of_lesson(&step, k, path));
        const uint bin = as_uint(lesson.x);
        if (bin == ENDS_HERE) return;
        if (bin == NO_BIN) continue;
        const float light = fmin((all - lesson.z * step.frame.guide.unit) / lesson.y, CLARAY_GUIDE_BRIGHTEST);
        atomic_inc(&bins[bin].paths);
        if (light > 0.0f) add_to_sum((volatile global uint*)&bins[bin].squares, (ulong)(light * light * CLARAY_GUIDE_PARTS));
    }
}
