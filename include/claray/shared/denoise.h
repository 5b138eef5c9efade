// What the denoiser knows of a pixel besides its samples, shared by the host and the kernels.
#ifndef CLARAY_SHARED_DENOISE_H
#define CLARAY_SHARED_DENOISE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// The first surfaces of a pixel. `glow` is the radiance that reaches the camera directly: of lamps, and of the sky.
/// Means over the camera rays of the film's samples, and means over these and further rays, which have less noise.
typedef struct Guide {
    float sampled_albedo_r, sampled_albedo_g, sampled_albedo_b;
    float sampled_glow_r, sampled_glow_g, sampled_glow_b;
    float albedo_r, albedo_g, albedo_b;
    float glow_r, glow_g, glow_b;
    float normal_x, normal_y, normal_z;  // shading normal on the camera's side; its mean is shorter than 1 at edges
    float nearness;                      // 1 / distance from the camera; 0 beyond all surfaces
} Guide;
CLARAY_LAYOUT(Guide, 64)

/// Scalar parameters of a filter pass.
typedef struct FilterStep {
    uint width, height;
    uint spacing;  // of the samples, in pixels
    uint last;     // 1: the last pass
} FilterStep;
CLARAY_LAYOUT(FilterStep, 16)

CLARAY_SHARED_END

#endif
