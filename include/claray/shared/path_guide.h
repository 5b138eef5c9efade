// Maps of the light that arrives at diffuse surfaces, by which paths choose directions; shared by the host and the
// render kernels.
#ifndef CLARAY_SHARED_PATH_GUIDE_H
#define CLARAY_SHARED_PATH_GUIDE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// Cells of the scene along each axis; a cell has a map for each of six directions of normals.
#define CLARAY_GUIDE_CELLS 8u
#define CLARAY_GUIDE_MAPS (CLARAY_GUIDE_CELLS * CLARAY_GUIDE_CELLS * CLARAY_GUIDE_CELLS * 6u)
/// Bins of the two random numbers of a direction: columns of the first, and in each rows of the second.
#define CLARAY_GUIDE_SIDE 8u
#define CLARAY_GUIDE_BINS (CLARAY_GUIDE_SIDE * CLARAY_GUIDE_SIDE)
/// Words of a map: the ends of its columns, then those of the rows of each column, in 16 bits each. The last end is
/// 65536, which stands for itself.
#define CLARAY_GUIDE_WORDS (CLARAY_GUIDE_SIDE / 2u * (1u + CLARAY_GUIDE_SIDE))
/// The first surfaces of a path, which teach the maps. Each has three floats: bin, throughput behind it, and the light
/// that its path had found before.
#define CLARAY_GUIDE_LESSONS 3u

/// What paths do with the maps.
typedef struct PathGuideData {
    float x, y, z;                    // corner of the cells
    float scale_x, scale_y, scale_z;  // cells per length
    float unit;                       // 1 / light: about the image's mean
    uint lessons;  // where they begin in the buffer of radiance, in floats per path; 0: paths teach nothing
    uint guides;   // 1: paths choose directions by the maps
} PathGuideData;
CLARAY_LAYOUT(PathGuideData, 36)

/// What paths found in a bin. Sums of integers do not depend on the order of the paths.
typedef struct GuideBin {
    ulong squares;  // of light, in 1 / CLARAY_GUIDE_PARTS of its unit
    uint paths, pad;
} GuideBin;
CLARAY_LAYOUT(GuideBin, 16)
#define CLARAY_GUIDE_PARTS 1048576.0f
#define CLARAY_GUIDE_BRIGHTEST 1024.0f  // the largest light that is learned: squares of a billion paths do not overflow

CLARAY_SHARED_END

#endif
