// Images with alpha: what a path adds by the surface that its camera ray meets first (MaterialRole).
#include "claray/shared/path.h"
#include "claray/shared/types.h"
#include "shade/surface_at_hit.clh"

#define ROLE_SURFACE 0u
#define ROLE_HOLDOUT 1u
#define ROLE_CATCHER 2u

/// For the first `step.capacity` paths, whose camera rays met `hits`. `roles`: of the materials. Of `radiance` only what surfaces show is
/// left; what shadow catchers show goes to `caught` (null: there are none). `weights`: for each path 1 for a surface, 1 for a catcher, and 0.
kernel void mask_paths(Step step, SCENE_PARAMETERS, global const SceneHit* hits, global const uint* roles, global float* radiance,
                       global float* weights, global float* caught) {
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    const Hit hit = hit_of(hits[i] INSTANCE_BUFFERS);
    const uint role = hit.primitive == CLARAY_MISS ? ROLE_HOLDOUT : roles[material_number_at(&step.frame, tables, hit)];
    vstore3((float3)(role == ROLE_SURFACE ? 1.0f : 0.0f, role == ROLE_CATCHER ? 1.0f : 0.0f, 0.0f), i, weights);
    if (caught) vstore3(role == ROLE_CATCHER ? vload3(i, radiance) : (float3)(0.0f), i, caught);
    if (role != ROLE_SURFACE) vstore3((float3)(0.0f), i, radiance);
}

/// For `paths` paths: `radiance` of those whose camera ray met a catcher, as the weights from path `first` on tell.
kernel void keep_caught(uint paths, uint first, global const float* weights, global float* radiance) {
    const uint i = get_global_id(0);
    if (i < paths && weights[3u * (first + i) + 1u] == 0.0f) vstore3((float3)(0.0f), i, radiance);
}
