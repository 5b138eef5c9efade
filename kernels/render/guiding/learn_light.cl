// Adds what the paths of a batch found to the bins of the path guide.
#define PATH_GUIDE 1
#include "render/guiding/path_guide.clh"

/// Not every device adds 64 bits at once: whoever makes the lower half overflow carries.
static inline void add_to_sum(volatile global uint* halves, ulong value) {
    const uint low = (uint)value, before = atomic_add(&halves[0], low);
    const uint high = (uint)(value >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0u) atomic_add(&halves[1], high);
}

/// Whether the image learns from a path: one run of pixels in `every`.
static inline bool is_chosen(const Batch* batch, uint every, uint path) {
    return path < batch->pixels * batch->samples && (batch->first_pixel + path / batch->samples) / CLARAY_GUIDE_RUN % every == 0u;
}

/// For each path: the light that came from the directions in which its first surfaces sent it.
kernel void learn_light(Step step, uint every, global const float* radiance, global GuideBin* bins) {
    const uint path = get_global_id(0);
    if (!is_chosen(&step.batch, every, path)) return;
    const float unit = step.frame.guide.unit, all = brightness_of(vload3(path, radiance)) * unit;
    if (!isfinite(all)) return;
    const uint fold = (step.batch.first_sample + path % step.batch.samples) % CLARAY_GUIDE_FOLDS;
    bins += fold * CLARAY_GUIDE_MAPS * CLARAY_GUIDE_BINS;
    for (uint k = 0; k < CLARAY_GUIDE_LESSONS; ++k) {
        const float3 lesson = vload3(0, radiance + place_of_lesson(&step, k, path));
        const uint bin = as_uint(lesson.x);
        if (bin == ENDS_HERE) return;
        if (bin == NO_BIN) continue;
        atomic_inc(&bins[bin].paths);
        if (k + 1u < CLARAY_GUIDE_LESSONS && as_uint(radiance[place_of_lesson(&step, k + 1u, path)]) != ENDS_HERE)
            atomic_inc(&bins[bin].longer);
        if (!(all > lesson.z * unit)) continue;
        const float found = fmin(all - lesson.z * unit, CLARAY_GUIDE_BRIGHTEST), light = fmin(found / lesson.y, CLARAY_GUIDE_BRIGHTEST);
        add_to_sum((volatile global uint*)&bins[bin].squares, (ulong)(light * light * CLARAY_GUIDE_PARTS));
        add_to_sum((volatile global uint*)&bins[bin].effect, (ulong)(found * found * CLARAY_GUIDE_PARTS));
    }
}

/// For each path: counts it by the exponent of its light. Zeros are the first.
kernel void count_exponents(Step step, uint every, global const float* radiance, volatile global uint* counts) {
    const uint path = get_global_id(0);
    if (!is_chosen(&step.batch, every, path)) return;
    const float light = brightness_of(vload3(path, radiance));
    if (light >= 0.0f && isfinite(light)) atomic_inc(&counts[as_uint(light) >> 23 & 0xffu]);
}
