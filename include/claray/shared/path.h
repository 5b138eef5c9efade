// Paths in flight and film data, shared by the host and the render kernels.
#ifndef CLARAY_SHARED_PATH_H
#define CLARAY_SHARED_PATH_H

#include "claray/shared/lists/along_rays.h"
#include "claray/shared/lists/tables.h"
#include "claray/shared/scene.h"

CLARAY_SHARED_BEGIN

/// State of a path that is stored with its ray.
typedef struct PathState {
    float throughput_r, throughput_g, throughput_b;  // radiance at the camera per radiance along this ray
    float pdf;    // density per steradian with which the BSDF samples the direction; 0: a delta function or the camera
    uint path;    // index in the batch
    uint pixel;   // of the image
    uint sample;  // number among those of the pixel
    uint flags;   // what alone the ray looks for: CLARAY_TO_HOT_SPOT, CLARAY_ONLY_SKY; 0: any light
} PathState;
CLARAY_LAYOUT(PathState, 32)
#define CLARAY_TO_HOT_SPOT 1u  // the light of the hot spot at which it is aimed
#define CLARAY_ONLY_SKY 2u

/// Radiance that a shadow ray adds to its path if the ray is not blocked.
typedef struct LightSample {
    float r, g, b;
    uint path;
} LightSample;
CLARAY_LAYOUT(LightSample, 16)

/// Adaptive sampling distributes samples to squares of so many pixels per side.
#define CLARAY_TILE_SIDE 8u

/// Consecutive pixels with `samples` consecutive samples each: path p is sample p % samples of pixel p / samples. A
/// listed batch has consecutive entries of the list SceneTables::listed_pixels instead of pixels: a pixel, and a number
/// that is added to those of the samples. A pixel may have several entries, one after the other.
typedef struct Batch {
    uint first_pixel, pixels;
    uint first_sample, samples;
    uint listed;  // 1: of entries
} Batch;
CLARAY_LAYOUT(Batch, 20)

#define CLARAY_NO_TABLE 0xffffffffu

/// Where the tables of a scene begin in their common buffer, in 32-bit words. CLARAY_NO_TABLE: the scene does not have
/// this table.
typedef struct SceneTables {
#define CLARAY_MEMBER(name) uint name;
    CLARAY_TABLES(CLARAY_MEMBER)
#undef CLARAY_MEMBER
} SceneTables;
#define CLARAY_TABLE_SIZE(name) +4
CLARAY_LAYOUT(SceneTables, 0 CLARAY_TABLES(CLARAY_TABLE_SIZE))

/// For studies: a ray that a rough surface scatters ends after `reach` and brings this radiance from there; a surface
/// before reflects it once.
typedef struct AmbientData {
    float radiance_r, radiance_g, radiance_b, reach;
} AmbientData;
CLARAY_LAYOUT(AmbientData, 16)

// Path guiding: maps of the light that arrives at diffuse surfaces, by which paths choose directions.

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
    ulong effect;   // the same of what this light adds to the image
    uint paths;
    uint longer;  // those of them that a surface scattered again, by the lessons that tell it: all but the last
} GuideBin;
CLARAY_LAYOUT(GuideBin, 24)
/// Samples of a pixel belong to so many parts in turn, so that maps of some parts can be tried on another one.
#define CLARAY_GUIDE_FOLDS 3u
/// Images of many pixels learn from some: runs of so many neighbours.
#define CLARAY_GUIDE_RUN 2048u
/// Paths by the exponents of their light, which tell its unit.
#define CLARAY_GUIDE_EXPONENTS 256u
#define CLARAY_GUIDE_PARTS 16384.0f
#define CLARAY_GUIDE_BRIGHTEST 1024.0f  // the largest light that is learned: squares of a billion paths do not overflow

/// Data that all paths of a render share.
typedef struct FrameData {
    CameraData camera;
    SkyData sky;
    AmbientData ambient;
    LightsData lights;
    uint width, height;
    uint seed;
    uint max_depth;  // largest number of surfaces that scatter a path
    SceneTables tables;
    PathGuideData guide;
} FrameData;
CLARAY_LAYOUT(FrameData, 260 + sizeof(SkyData) + sizeof(SceneTables))

/// Scalar parameters of a stage.
typedef struct Step {
    Batch batch;
    FrameData frame;
    uint depth;     // number of surfaces that the paths have hit; for trace_paths: largest number of waves
    uint capacity;  // rays in the queue, as far as the host knows
    uint room;      // capacity of the queues in paths, a multiple of CLARAY_QUEUE_ROOM
    uint waves;     // number of rays after which paths are not followed: surfaces scatter no ray beyond
} Step;
CLARAY_LAYOUT(Step, 36 + sizeof(FrameData))

/// With this room, every array in a queue begins at a multiple of 1024 bytes, the alignment of sub-buffers.
#define CLARAY_QUEUE_ROOM 256u

/// A word of a ray queue. The queue consists of consecutive arrays with `room` elements each: Ray, PathState, those of
/// CLARAY_ALONG_RAYS, and the rays' times (float).
typedef struct RayQueue {
    uint word;
} RayQueue;
CLARAY_LAYOUT(RayQueue, 4)
/// Words per path before the arrays: of the states, of each of CLARAY_ALONG_RAYS by its name, of the times, and of all.
#define CLARAY_ARRAY(name, type, words, TAKEN) \
    CLARAY_QUEUE_##name, CLARAY_LAST_OF_##name = CLARAY_QUEUE_##name + words - 1,
// clang-format off
enum {
    CLARAY_QUEUE_STATES = 8,
    CLARAY_LAST_OF_STATES = 15,
    CLARAY_ALONG_RAYS(CLARAY_ARRAY)
    CLARAY_QUEUE_TIMES,
    CLARAY_QUEUE_WORDS
};
// clang-format on
#undef CLARAY_ARRAY

/// A word of a shadow-ray queue: Ray, LightSample, and the rays' times.
typedef struct ShadowQueue {
    uint word;
} ShadowQueue;
CLARAY_LAYOUT(ShadowQueue, 4)
#define CLARAY_SHADOW_LIGHT 8u
#define CLARAY_SHADOW_TIMES 12u
#define CLARAY_SHADOW_WORDS 13u

/// Number of rays in each queue: three queues of rays and two of shadow rays, used in turn by depth. Then the sums of
/// both over a batch, two words each. The distance between lengths permits sub-buffers.
typedef struct QueueLength {
    uint length;
    uint pad[255];
} QueueLength;
CLARAY_LAYOUT(QueueLength, 1024)
#define CLARAY_RAY_QUEUES 3u
#define CLARAY_SHADOW_QUEUES 2u
/// Most kernels of a scene that each shade some of its materials (MaterialData::shader). Behind the lengths of the
/// queues are the numbers of rays for each of these kernels, of the surfaces at even depths and at odd ones.
#define CLARAY_MOST_SHADERS 12u
#define CLARAY_QUEUE_LENGTHS (CLARAY_RAY_QUEUES + CLARAY_SHADOW_QUEUES + 2u * CLARAY_MOST_SHADERS)

/// A sum of colours in two parts. The value is the sum of both parts.
typedef struct ColorSum {
    float r, g, b;
    float lost_r, lost_g, lost_b;  // rounding errors
} ColorSum;
CLARAY_LAYOUT(ColorSum, 24)

/// The sums of a pixel. The luminance of samples with odd index is also summed separately, in two parts, to estimate
/// the noise.
typedef struct FilmPixel {
    ColorSum all;
    float odd_sum, odd_error;  // luminance
    uint count, odd_count;     // samples in the sums
    uint dropped;              // samples left out: NaN, infinite, or too large to sum
} FilmPixel;
CLARAY_LAYOUT(FilmPixel, 44)

/// Sums over some pixels, to compute the noise of an image.
typedef struct NoiseSums {
    float variance;   // of the pixels' means
    float luminance;  // of the pixels' means
    uint pixels;      // pixels with at least two samples
    uint dropped;
} NoiseSums;
CLARAY_LAYOUT(NoiseSums, 16)

// Items and their groups that sum up a film. Sums are rounded in the order of these on all devices, since adaptive
// sampling and stops at an error depend on them.
#define CLARAY_SUM_ITEMS 65536u
#define CLARAY_SUM_GROUP 256u

CLARAY_SHARED_END

#endif
