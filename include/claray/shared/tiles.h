// Tiles of the image with lists of the lights that reach their surfaces, shared by the host and kernels/deferred.
#ifndef CLARAY_SHARED_TILES_H
#define CLARAY_SHARED_TILES_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

#define CLARAY_TILE 16u                // pixels per side
#define CLARAY_TILE_BLOCK 4u           // tiles per side of a block
#define CLARAY_TILE_SLICES 4u          // of a tile's surfaces
#define CLARAY_LIGHT_BOUNDS 8u         // numbers of a light: where it can shine, see bound_lights
#define CLARAY_ALL_LIGHTS 0xffffffffu  // instead of a list's length: it would have been too long

/// The tiles that cover the rows of a batch. Blocks of tiles are numbered in the same way, row by row.
typedef struct TileGrid {
    uint first_row;      // of pixels
    uint columns, rows;  // of tiles
    uint block_columns, block_rows;
    uint lights;                 // those without extent, of the scene
    uint bounds_stride;          // between the bounds of a light
    uint tile_room, block_room;  // longest lists
} TileGrid;
CLARAY_LAYOUT(TileGrid, 36)

/// A box around surfaces; lo > hi if there are none.
typedef struct TileBox {
    float lo_x, lo_y, lo_z, hi_x, hi_y, hi_z;
} TileBox;
CLARAY_LAYOUT(TileBox, 24)

/// Boxes around the surfaces that a tile shows, and around those in each slice of that box across its longest axis.
typedef struct TileBoxes {
    TileBox all;
    TileBox slices[CLARAY_TILE_SLICES];
} TileBoxes;
CLARAY_LAYOUT(TileBoxes, 120)

CLARAY_SHARED_END

#endif
