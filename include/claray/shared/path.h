// Paths in flight and the images they end in, as the host and the render kernels see them.
#ifndef CLARAY_SHARED_PATH_H
#define CLARAY_SHARED_PATH_H

#include "claray/shared/scene.h"

CLARAY_SHARED_BEGIN

/// What travels with a ray of a path.
typedef struct PathState {
    float throughput_r, throughput_g, throughput_b;  // radiance at the camera per radiance along this ray
    float pdf;  // per steradian, with which the ray's direction was sampled; 0: by a delta function or the camera;
                // negative: it goes to a hot spot, this is minus the density with which the BSDF would have sampled it
    uint path;  // index in the batch
} PathState;
CLARAY_LAYOUT(PathState, 20)

/// What a shadow ray adds to its path's radiance if nothing is in its way.
typedef struct LightSample {
    float r, g, b;
    uint path;
} LightSample;
CLARAY_LAYOUT(LightSample, 16)

/// Consecutive pixels, each with `samples` consecutive samples: path p is sample p % samples of pixel p / samples.
typedef struct Batch {
    uint first_pixel, pixels;
    uint first_sample, samples;
} Batch;
CLARAY_LAYOUT(Batch, 16)

#define CLARAY_NO_TABLE 0xffffffffu

/// Where the tables of a scene begin in the memory that they share, in words of 32 bits; CLARAY_NO_TABLE where it has
/// none.
typedef struct SceneTables {
    uint normals;             // float, 3 a vertex
    uint triangle_materials;  // uint
    uint materials;           // MaterialData
    uint energy;              // float, see energy.h
    uint triangle_lights, punctual_lights, light_tree, light_leaves, light_trails, hot_spots, lamps;
    uint environment_texels, environment_cdf;  // float
} SceneTables;
CLARAY_LAYOUT(SceneTables, 52)

/// What all paths of a render share.
typedef struct FrameData {
    CameraData camera;
    SkyData sky;
    LightsData lights;
    uint width, height;
    uint seed;
    uint max_depth;  // surfaces that scatter, at most
    SceneTables tables;
} FrameData;
CLARAY_LAYOUT(FrameData, 268)

/// Scalars of a stage.
typedef struct Step {
    Batch batch;
    FrameData frame;
    uint depth;     // surfaces that the paths have met; of trace_paths: at most so many waves
    uint capacity;  // rays of the queue, as far as the host knows
    uint room;      // paths that queues have room for, a multiple of CLARAY_QUEUE_ROOM
} Step;
CLARAY_LAYOUT(Step, 296)

/// With this room every array in a queue begins at a multiple of 1024 bytes, where a sub-buffer may begin.
#define CLARAY_QUEUE_ROOM 256u

/// A word of a queue of rays: arrays behind one another, of `room` elements each: Ray, PathState, RayCone (8 bytes), and
/// the rays' times (float).
typedef struct RayQueue {
    uint word;
} RayQueue;
CLARAY_LAYOUT(RayQueue, 4)
#define CLARAY_QUEUE_STATES 8u  // words a path before the array
#define CLARAY_QUEUE_CONES 13u
#define CLARAY_QUEUE_TIMES 15u
#define CLARAY_QUEUE_WORDS 16u

/// The same of shadow rays: Ray, LightSample, and the rays' times.
typedef struct ShadowQueue {
    uint word;
} ShadowQueue;
CLARAY_LAYOUT(ShadowQueue, 4)
#define CLARAY_SHADOW_LIGHT 8u
#define CLARAY_SHADOW_TIMES 12u
#define CLARAY_SHADOW_WORDS 13u

/// How many rays are in which queue: three of rays and two of shadow rays, by turns of the depth; then the sums of both
/// over a batch, as two words each. Each is so far apart that it may be a sub-buffer.
typedef struct QueueLength {
    uint length;
    uint pad[255];
} QueueLength;
CLARAY_LAYOUT(QueueLength, 1024)
#define CLARAY_RAY_QUEUES 3u
#define CLARAY_SHADOW_QUEUES 2u

/// A sum of colours in two parts: their own sum is the value.
typedef struct ColorSum {
    float r, g, b;
    float lost_r, lost_g, lost_b;  // by rounding
} ColorSum;
CLARAY_LAYOUT(ColorSum, 24)

/// A pixel's sums. The luminance of the samples of odd index is summed once more, in two parts, too, for the estimate
/// of the noise.
typedef struct FilmPixel {
    ColorSum all;
    float odd_sum, odd_error;  // luminance
    uint count, odd_count;     // samples in the sums
    uint dropped;              // samples left out: NaN, infinite, or too large to sum
} FilmPixel;
CLARAY_LAYOUT(FilmPixel, 44)

/// Sums over some pixels, for the noise of an image.
typedef struct NoiseSums {
    float variance;   // of the pixels' means
    float luminance;  // of the pixels' means
    uint pixels;      // with two samples or more
    uint dropped;
} NoiseSums;
CLARAY_LAYOUT(NoiseSums, 16)

/// Sums over some pixels, for the error of an image.
typedef struct ErrorSums {
    float variance;  // of the pixels' means, all channels
    float squares;   // of the pixels' variances
    float value;     // the pixels' means, all channels
    uint pixels;     // with samples of even and of odd index
} ErrorSums;
CLARAY_LAYOUT(ErrorSums, 16)

/// What one look at a film tells.
typedef struct FilmSums {
    NoiseSums noise;
    ErrorSums error;  // where the samples of odd index have sums of their own
} FilmSums;
CLARAY_LAYOUT(FilmSums, 32)

CLARAY_SHARED_END

#endif
