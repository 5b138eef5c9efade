// Which corners of its cell each part of a cell sees, from the hits of the rays of aim_cells.cl. A part that sees more backs of triangles
// than fronts lies inside an object, or behind a surface: it is treated as if it saw no corner.
#include "claray/shared/path.h"
#include "light_grid/light_grid.clh"
#include "shade/surface_at_hit.clh"

/// The byte of a part, from its eight rays.
static inline uint seen_by_part(const FrameData* frame, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits) {
    uint seen = 0;
    int fronts = 0;
    for (uint corner = 0; corner < 8; ++corner) {
        if (hits[corner].primitive == CLARAY_MISS) {
            seen |= 1u << corner;
            continue;
        }
        ShadingPoint at;
        surface_seen(frame, SCENE, queued_ray(&rays[corner]), hits[corner], &at);
        fronts += at.surface.inside ? -1 : 1;
    }
    return fronts < 0 ? 0u : seen;
}

/// One work-item per word: four parts.
kernel void mark_cells(Step step, GridBox box, SCENE_PARAMETERS, global uint* grid_tables, global const RayQueue* queue,
                       global const SceneHit* hits) {
    const uint item = get_global_id(0), cell = item / CLARAY_GRID_WORDS, word = item % CLARAY_GRID_WORDS;
    if (cell >= step.batch.pixels) return;
    const uint first = step.frame.tables.light_grid;
    global const LightGrid* grid = level_of_grid(tables + first, box.level);
    uint bits = 0;
    for (uint i = 0; i < 4; ++i) {
        const uint path = 32 * item + 8 * i;
        bits |= seen_by_part(&step.frame, SCENE, (global const Ray*)queue + path, hits + path) << 8 * i;
    }
    const uint place = place_in_grid(grid, item_of_box(&box, step.batch.first_pixel + cell));
    grid_tables[first + grid->seen + CLARAY_GRID_WORDS * place + word] = bits;
}
