// The list of the cameras' projections, and their formulas for the host and for kernels (kernels/shade/camera.clh,
// docs/architecture.md). The kinds, their names, effects, options and scenes are made from it.
#ifndef CLARAY_SHARED_LISTS_PROJECTIONS_H
#define CLARAY_SHARED_LISTS_PROJECTIONS_H

#include "claray/shared/angles.h"
#include "claray/shared/portable.h"

#ifndef __OPENCL_C_VERSION__
#include <cmath>
#endif

// Values of CameraData::projection, and bit numbers in the kernels' PROJECTIONS.
#define CLARAY_PERSPECTIVE 0u
#define CLARAY_ORTHOGRAPHIC 1u
#define CLARAY_PANORAMA 2u
#define CLARAY_CUBE 3u
#define CLARAY_FISHEYE 4u
#define CLARAY_EQUISOLID 5u
// Bit numbers in PROJECTIONS only: what a camera of any projection may have.
#define CLARAY_STEREO 6u
#define CLARAY_SHIFT 7u
#define CLARAY_TILT 8u

// CameraData::projection: the projection in its low bits, and these. The camera does not move: `view` and `above` of
// CameraData then hold numbers of the lens (claray/shared/camera/lens.h).
#define CLARAY_KIND_BITS 0xffu
#define CLARAY_SIDE_BY_SIDE 0x100u
#define CLARAY_TOP_BOTTOM 0x200u
#define CLARAY_SHIFTED 0x400u
#define CLARAY_TILTED 0x800u

#ifdef __OPENCL_C_VERSION__
#ifndef PROJECTIONS
#define PROJECTIONS 0xffffffffu  // the projections that a scene calls for, beside perspective
#endif
#define CLARAY_USES_PROJECTION(NAME) (PROJECTIONS >> CLARAY_##NAME & 1u)
// Kernels of other scenes have no text of these.
#define CLARAY_USES_LENSES (PROJECTIONS >> 3)
#else
#define CLARAY_USES_PROJECTION(NAME) true
#define CLARAY_USES_LENSES 1
#endif

#if CLARAY_USES_LENSES
#define CLARAY_KIND_OF(projection) (projection & CLARAY_KIND_BITS)
#else
#define CLARAY_KIND_OF(projection) projection
#endif

// A row is X(name, NAME, "name for users", flat, parallel, stretch):
//   name      Projection::name, Effect::name, and below aim_name and place_name
//   NAME      the number is CLARAY_NAME
//   flat      1: the image is a plane: it has lenses, and a matrix describes it
//   parallel  1: all rays are parallel
//   stretch   the angle that a step of `up` spans at the image's centre, over the length of `up`

#define CLARAY_PLAIN_PROJECTIONS(X)                          \
    X(orthographic, ORTHOGRAPHIC, "orthographic", 1, 1, 1.f) \
    X(panorama, PANORAMA, "panorama", 0, 0, 1.57079633f)

/// Projections whose functions take `half_width` and `half_height` of CameraData, too.
#if CLARAY_USES_LENSES
#define CLARAY_WIDE_PROJECTIONS(X)            \
    X(cube, CUBE, "cube", 0, 0, 1.f)          \
    X(fisheye, FISHEYE, "fisheye", 0, 0, 1.f) \
    X(equisolid, EQUISOLID, "equisolid", 0, 0, 1.f)
#else
#define CLARAY_WIDE_PROJECTIONS(X)
#endif

/// Every camera that is not perspective is an effect.
#define CLARAY_OTHER_PROJECTIONS(X) CLARAY_PLAIN_PROJECTIONS(X) CLARAY_WIDE_PROJECTIONS(X)

#define CLARAY_PROJECTIONS(X)                             \
    X(perspective, PERSPECTIVE, "perspective", 1, 0, 1.f) \
    CLARAY_OTHER_PROJECTIONS(X)

CLARAY_SHARED_BEGIN

#ifdef __OPENCL_C_VERSION__
typedef float ProjectionReal;
#else
using ProjectionReal = double;
#endif

/// A ray in the camera's axes: multiples of CameraData's `right`, `up` and `forward`. It starts in the plane of the
/// position.
typedef struct ProjectionRay {
    ProjectionReal from_right, from_up, right, up, forward;
} ProjectionRay;

/// A point of the image, -1 to 1 on both axes, y upwards. `seen`: 0 if the camera does not see the point of space.
typedef struct ProjectionPlace {
    ProjectionReal x, y;
    uint seen;
} ProjectionPlace;

// aim_NAME: the ray through a point of the image. place_NAME: where a point of space is seen, from its coordinates
// along the camera's axes.

CLARAY_SHARED_FUNCTION ProjectionRay aim_perspective(ProjectionReal x, ProjectionReal y) {
    const ProjectionRay ray = {0, 0, x, y, 1};
    return ray;
}
CLARAY_SHARED_FUNCTION ProjectionPlace place_perspective(ProjectionReal right, ProjectionReal up,
                                                         ProjectionReal forward) {
    const ProjectionPlace place = {right / forward, up / forward, forward > 0};
    return place;
}

CLARAY_SHARED_FUNCTION ProjectionRay aim_orthographic(ProjectionReal x, ProjectionReal y) {
    const ProjectionRay ray = {x, y, 0, 0, 1};
    return ray;
}
CLARAY_SHARED_FUNCTION ProjectionPlace place_orthographic(ProjectionReal right, ProjectionReal up,
                                                          ProjectionReal forward) {
    const ProjectionPlace place = {right, up, forward > 0};
    return place;
}

/// All directions: x is the longitude, y the latitude (equirectangular, as images of surroundings are).
CLARAY_SHARED_FUNCTION ProjectionRay aim_panorama(ProjectionReal x, ProjectionReal y) {
    const ProjectionReal longitude = x, latitude = y / 2;  // in half turns
    const ProjectionReal level = claray_cosine(latitude);
    const ProjectionRay ray = {0, 0, claray_sine(longitude) * level, claray_sine(latitude),
                               claray_cosine(longitude) * level};
    return ray;
}
CLARAY_SHARED_FUNCTION ProjectionPlace place_panorama(ProjectionReal right, ProjectionReal up, ProjectionReal forward) {
    const ProjectionReal aside = sqrt(right * right + forward * forward);
    const ProjectionPlace place = {claray_half_turns(right, forward), 2 * claray_half_turns(up, aside), 1};
    return place;
}

CLARAY_SHARED_FUNCTION ProjectionRay aim_ray(uint projection, ProjectionReal x, ProjectionReal y) {
#define CLARAY_AIM(name, NAME, text, flat, parallel, stretch) \
    if (CLARAY_USES_PROJECTION(NAME) && CLARAY_KIND_OF(projection) == CLARAY_##NAME) return aim_##name(x, y);
    CLARAY_PLAIN_PROJECTIONS(CLARAY_AIM)
#undef CLARAY_AIM
    return aim_perspective(x, y);
}

CLARAY_SHARED_FUNCTION ProjectionPlace place_in_image(uint projection, ProjectionReal right, ProjectionReal up,
                                                      ProjectionReal forward) {
#define CLARAY_PLACE(name, NAME, text, flat, parallel, stretch)                      \
    if (CLARAY_USES_PROJECTION(NAME) && CLARAY_KIND_OF(projection) == CLARAY_##NAME) \
        return place_##name(right, up, forward);
    CLARAY_PLAIN_PROJECTIONS(CLARAY_PLACE)
#undef CLARAY_PLACE
    return place_perspective(right, up, forward);
}

CLARAY_SHARED_FUNCTION bool has_parallel_rays(uint projection) {
#define CLARAY_PARALLEL(name, NAME, text, flat, parallel, stretch) \
    if (CLARAY_USES_PROJECTION(NAME) && CLARAY_KIND_OF(projection) == CLARAY_##NAME) return parallel != 0;
    CLARAY_OTHER_PROJECTIONS(CLARAY_PARALLEL)
#undef CLARAY_PARALLEL
    return false;
}

CLARAY_SHARED_FUNCTION ProjectionReal stretch_of_projection(uint projection) {
#define CLARAY_IMAGE_STRETCH(name, NAME, text, flat, parallel, stretch) \
    if (CLARAY_USES_PROJECTION(NAME) && CLARAY_KIND_OF(projection) == CLARAY_##NAME) return stretch;
    CLARAY_OTHER_PROJECTIONS(CLARAY_IMAGE_STRETCH)
#undef CLARAY_IMAGE_STRETCH
    return 1;
}

CLARAY_SHARED_END

#endif
