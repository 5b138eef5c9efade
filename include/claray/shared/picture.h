// Sizes of images (render/resolve_film.cl), and the table by which render/tone_map.cl encodes 8-bit sRGB.
#ifndef CLARAY_SHARED_PICTURE_H
#define CLARAY_SHARED_PICTURE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// Sizes in pixels: of a film, and of the image made of it.
typedef struct ImageSizes {
    uint width, height, image_width, image_height;
} ImageSizes;
CLARAY_LAYOUT(ImageSizes, 16)

// A cell of the table is a float's exponent and the eight leading bits of its mantissa, from 2^-13 to 1: values below
// 2^-13 are black.
#define CLARAY_SRGB_SHIFT 15u
#define CLARAY_SRGB_LEAST (0x39000000u >> CLARAY_SRGB_SHIFT)
#define CLARAY_SRGB_CELLS 3328u
#define CLARAY_SRGB_STEPS 1u  // most bytes that begin within a cell

typedef struct SrgbTable {
    float step[257];                // the least value of each byte; infinite after the last
    uint first[CLARAY_SRGB_CELLS];  // the byte of each cell's least value
} SrgbTable;
CLARAY_LAYOUT(SrgbTable, 14340)

CLARAY_SHARED_END

#endif
