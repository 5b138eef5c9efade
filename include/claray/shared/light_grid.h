// A grid of light: probes at the corners of cells hold the light that arrives there, as spherical harmonics. Shared by
// the host and the kernels of lights/light_grid.clh and light_grid.
#ifndef CLARAY_SHARED_LIGHT_GRID_H
#define CLARAY_SHARED_LIGHT_GRID_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// One level of the grid. The table of the scene holds the levels, from fine to coarse, in structs of
/// CLARAY_GRID_HEADER words; then the levels' data. Probes and cells of a level that follows the viewer keep their
/// places in memory when it moves, because their places are taken modulo `side`.
typedef struct LightGrid {
    float x, y, z;                       // the first probe
    float step_x, step_y, step_z;        // from one probe to the next
    uint first_x, first_y, first_z;      // its place, modulo `side`
    uint side;                           // probes per axis, at least 2
    float center_x, center_y, center_z;  // the viewer
    float reach;        // the level ends at this distance from the viewer along an axis, in steps; 0: it does not move
    uint coefficients;  // per colour: 4 or 9
    uint levels;
    uint gather;  // surfaces that a path meets before the grid answers
    uint seen;    // words before the cells' bits: for each of 64 parts of a cell, which of its corners the part sees
    uint probes;  // words before the probes: a float4 per coefficient; w of the first is the number of rays
    uint voxels;  // 1: the probes are the voxels of surfaces, with 4 coefficients; `seen` is a float4 per voxel: the
                  // surface's albedo, and 1 if there is a surface
    uint pad[4];
} LightGrid;
#define CLARAY_GRID_HEADER 24u
CLARAY_LAYOUT(LightGrid, 96)

#define CLARAY_GRID_PARTS 4u       // of a cell, per axis
#define CLARAY_GRID_WORDS 16u      // of a cell's bits: a byte per part
#define CLARAY_RAYS_PER_CELL 512u  // from 64 parts to 8 corners

#define CLARAY_RAYS_PER_VOXEL 6u  // through its sides

/// Probes or cells of a level: `first` and `count` along each axis, from the level's first probe.
typedef struct GridBox {
    uint level;
    uint x, y, z;
    uint width, height, depth;
} GridBox;
CLARAY_LAYOUT(GridBox, 28)

CLARAY_SHARED_END

#endif
