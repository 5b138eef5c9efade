// Which corners of its cell each part of a cell sees, from the hits of the rays of aim_cells.cl.
#include "claray/shared/path.h"
#include "light_grid/light_grid.clh"
#include "shade/instance.clh"

/// One work-item per word: four parts.
kernel void mark_cells(Step step, GridBox box, global uint* tables, global const SceneHit* hits) {
    const uint item = get_global_id(0), cell = item / CLARAY_GRID_WORDS, word = item % CLARAY_GRID_WORDS;
    if (cell >= step.batch.pixels) return;
    global const uint* table = tables + step.frame.tables.light_grid;
    global const LightGrid* grid = level_of_grid(table, box.level);
    uint bits = 0;
    for (uint i = 0; i < 32; ++i)
        if (hits[32 * item + i].primitive == CLARAY_MISS) bits |= 1u << i;
    const uint place = place_in_grid(grid, item_of_box(&box, step.batch.first_pixel + cell));
    tables[step.frame.tables.light_grid + grid->seen + CLARAY_GRID_WORDS * place + word] = bits;
}
