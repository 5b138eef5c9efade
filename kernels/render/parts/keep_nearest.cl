// The stage after a query of a part of a scene that is split: keeps the nearest hit of each ray, and whether a shadow ray is blocked.
#include "claray/shared/types.h"
#include "shade/instance.clh"

#if INSTANCES
static inline uint instance_of(SceneHit hit) { return hit.instance; }
#else
static inline uint instance_of(SceneHit hit) { return 0u; }
#endif

/// Of equal distances the lower instance wins, then the lower triangle, as in one tree.
static inline bool is_nearer(SceneHit a, SceneHit b) {
    if (a.primitive == CLARAY_MISS || b.primitive == CLARAY_MISS) return b.primitive == CLARAY_MISS && a.primitive != CLARAY_MISS;
    if (a.t != b.t) return a.t < b.t;
    if (instance_of(a) != instance_of(b)) return instance_of(a) < instance_of(b);
    return a.primitive < b.primitive;
}

/// `found`: of one part, whose instances have these `numbers` in the scene. `first`: nothing is in `nearest` yet. The rays end at
/// their nearest hit from now on. `visits` and `sum`: of the part and of all so far, or absent; the sum replaces both.
kernel void keep_nearest(global const uint* count, uint capacity, global const SceneHit* found, global const uint* numbers, uint first,
                         global SceneHit* nearest, global Ray* rays, global Visits* visits, global Visits* sum) {
    const uint i = get_global_id(0);
    if (i >= (count ? min(*count, capacity) : capacity)) return;
    SceneHit hit = found[i];
#if INSTANCES
    if (hit.primitive != CLARAY_MISS) hit.instance = numbers[hit.instance];
#endif
    if (first || is_nearer(hit, nearest[i])) {
        nearest[i] = hit;
        if (hit.primitive != CLARAY_MISS) rays[i].tmax = hit.t;
    }
    if (visits) {
        if (!first) visits[i].nodes += sum[i].nodes, visits[i].triangles += sum[i].triangles;
        sum[i] = visits[i];
    }
}

/// Blocked rays are not traced any more: they end before they begin.
kernel void keep_blocked(global const uint* count, uint capacity, global const uchar* found, uint first, global uchar* occluded,
                         global Ray* rays) {
    const uint i = get_global_id(0);
    if (i >= (count ? min(*count, capacity) : capacity)) return;
    const bool blocked = found[i] || (!first && occluded[i]);
    occluded[i] = blocked;
    if (blocked) rays[i].tmax = -1.0f;
}
