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

/// What all paths of a render share.
typedef struct FrameData {
    CameraData camera;
    SkyData sky;
    LightsData lights;
    uint width, height;
    uint seed;
    uint max_depth;  // surfaces that scatter, at most
} FrameData;
CLARAY_LAYOUT(FrameData, 216)

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
