// What the denoiser knows of a pixel besides its samples, shared by the host and the kernels.
#ifndef CLARAY_SHARED_DENOISE_H
#define CLARAY_SHARED_DENOISE_H

#include "claray/shared/path.h"

CLARAY_SHARED_BEGIN

/// What a pixel sees. `glow` is the radiance that reaches the camera from lamps and the sky without being scattered by
/// a rough surface; `albedo` is that of the first rough surface. Means over the camera rays of the film's samples, and
/// means over these and further rays, which have less noise.
typedef struct Guide {
    float sampled_albedo_r, sampled_albedo_g, sampled_albedo_b;
    float sampled_glow_r, sampled_glow_g, sampled_glow_b;
    float albedo_r, albedo_g, albedo_b;
    float glow_r, glow_g, glow_b;
    float normal_x, normal_y, normal_z;  // shading normal on the camera's side; its mean is shorter than 1 at edges
    float nearness;                      // 1 / distance from the camera; 0 beyond all surfaces
} Guide;
CLARAY_LAYOUT(Guide, 64)

/// What one camera ray sees: through mirrors and smooth glass, which scatter it in one direction.
typedef struct Sight {
    float throughput_r, throughput_g, throughput_b;  // of the mirrors and glass so far
    float albedo_r, albedo_g, albedo_b;              // of the first other surface, times the throughput
    float glow_r, glow_g, glow_b;
    float normal_x, normal_y, normal_z;  // of the first surface, as its nearness
    float nearness;
} Sight;
CLARAY_LAYOUT(Sight, 52)

/// Scalar parameters of the stages that trace guides. `step.batch` counts pixels of a list if `listed` is 1;
/// `step.depth` is the number of mirrors that the rays have met, and `step.capacity` the number of rays.
typedef struct GuideStep {
    Step step;
    uint listed;
} GuideStep;
CLARAY_LAYOUT(GuideStep, 328)

/// Scalar parameters of a filter pass.
typedef struct FilterStep {
    uint width, height;
    uint spacing;  // of the samples, in pixels
} FilterStep;
CLARAY_LAYOUT(FilterStep, 12)

/// The camera of a frame and that of the frame before.
typedef struct CameraPair {
    CameraData now, before;
} CameraPair;
CLARAY_LAYOUT(CameraPair, 232)

CLARAY_SHARED_END

#endif
