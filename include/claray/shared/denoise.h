// What the denoiser knows of a pixel besides its samples, shared by the host and the kernels.
#ifndef CLARAY_SHARED_DENOISE_H
#define CLARAY_SHARED_DENOISE_H

#include "claray/shared/path.h"

CLARAY_SHARED_BEGIN

/// What a pixel sees. `glow` is the radiance that reaches the camera from lamps and the sky without being scattered by
/// a rough surface. Surfaces that are almost mirrors scatter `gloss` of it. `albedo` is of the first rough
/// surface. Means over the camera rays of the film's samples (`sampled_glow` includes gloss), and means over these and
/// further rays, which have less noise.
/// GPUs read and write it by vectors of four words.
typedef struct CLARAY_ALIGNED(16) Guide {
    float sampled_albedo_r, sampled_albedo_g, sampled_albedo_b;
    float sampled_glow_r, sampled_glow_g, sampled_glow_b;
    float odd_glow;  // luminance of the glow of the film's samples of odd index, as a sum
    float albedo_r, albedo_g, albedo_b;
    float glow_r, glow_g, glow_b;
    float gloss_r, gloss_g, gloss_b;
    float albedo_variance, glow_variance, gloss_variance;  // of the means' luminance
    float mirrored;                      // share of the rays that mirrors, glass and almost mirrors passed on
    float normal_x, normal_y, normal_z;  // shading normal on the camera's side; its mean is shorter than 1 at edges
    float nearness;                      // 1 / distance from the camera; 0 beyond all surfaces
    float ray_variance;                  // of the luminance of one ray's glow and gloss
    uint rays;                           // that were traced
    uint complete;  // 1: all samples of the film are among them; 0: gloss is that of the film, and so is its noise
} Guide;
CLARAY_LAYOUT(Guide, 112)

/// What finds edges: of a pixel's rays the mean luminance of glow and gloss, and the variance of one ray.
typedef struct Glow {
    float mean, variance;
    uint rays;
} Glow;
CLARAY_LAYOUT(Glow, 12)

#define CLARAY_EDGE_CLASSES 64u  // of pixels by the noise of their glow

#define CLARAY_MOST_DOUBT 1.25f  // how many times variances count beyond once, if samples are few

/// What one camera ray sees: through mirrors and smooth glass, which scatter it in one direction, and by almost
/// mirrors.
typedef struct CLARAY_ALIGNED(16) Sight {
    float throughput_r, throughput_g, throughput_b;  // of the mirrors and glass so far
    float albedo_r, albedo_g, albedo_b;              // of the first other surface, times the throughput
    float glow_r, glow_g, glow_b;
    float normal_x, normal_y, normal_z;  // of the first surface, as its nearness
    float nearness;
    float gloss_r, gloss_g, gloss_b;
    float pdf;    // density of the direction of the next ray; 0: a mirror's
    uint passed;  // on by mirrors: CLARAY_BY_MIRROR, or also by an almost mirror: CLARAY_BY_GLOSS
#define CLARAY_MEMBER(name, type, words, TAKEN) type name;
    CLARAY_ALONG_SIGHTS(CLARAY_MEMBER)
#undef CLARAY_MEMBER
} Sight;
CLARAY_LAYOUT(Sight, 80)
#define CLARAY_BY_MIRROR 1u
#define CLARAY_BY_GLOSS 2u

#define CLARAY_GUIDE_GROUP 64u    // work-items that write guides together, except on CPUs
#define CLARAY_LANES_OF_EDGE 32u  // of them share the sights of a pixel at an edge: up to 4,096

/// Pixels of a batch with the same number of rays each, from this pixel and this ray of the batch on.
typedef struct GuideRun {
    uint first_pixel, first_ray, samples;
} GuideRun;
CLARAY_LAYOUT(GuideRun, 12)

/// Scalar parameters of the stages that trace guides. `step.batch` counts pixels of a list if `listed` is 1;
/// `step.depth` is the number of mirrors that the rays have met, and `step.capacity` the number of rays.
typedef struct GuideStep {
    Step step;
    uint listed;
    uint run_count;  // of the batch; they are in a buffer, since OpenCL grants a kernel's arguments only 1,024 bytes
} GuideStep;
CLARAY_LAYOUT(GuideStep, 8 + sizeof(Step))

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
