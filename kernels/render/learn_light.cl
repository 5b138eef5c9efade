// Adds what the paths of a batch found to the bins of the path guide.
#define PATH_GUIDE 1
#include "render/path_guide.clh"

#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable

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
        if (light > 0.0f) atom_add(&bins[bin].squares, (ulong)(light * light * CLARAY_GUIDE_PARTS));
    }
}
