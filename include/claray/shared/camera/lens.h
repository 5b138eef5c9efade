// Cameras with lenses beyond the perspective one: projections that need the image's extent, two eyes, shift and tilt.
// For the host and for kernels of scenes that have them (CLARAY_USES_LENSES).
#ifndef CLARAY_SHARED_CAMERA_LENS_H
#define CLARAY_SHARED_CAMERA_LENS_H

#include "claray/shared/lists/projections.h"
#include "claray/shared/scene.h"

#if CLARAY_USES_LENSES

// Numbers of the lens, in members of CameraData that only cameras in motion need otherwise.
#define CLARAY_LENS_SHIFT_X view_x  // of the points of the image, in its units
#define CLARAY_LENS_SHIFT_Y view_y
#define CLARAY_LENS_EYE view_z        // half the distance between the eyes
#define CLARAY_LENS_NEARNESS above_x  // 1 / the distance at which both eyes see a point at the same place
#define CLARAY_LENS_TILT_X above_y    // the sharp plane: forward * (1 + tilt_x * right + tilt_y * up) = focus
#define CLARAY_LENS_TILT_Y above_z

#ifdef __OPENCL_C_VERSION__
#define CLARAY_LENS_PI PI
#else
#define CLARAY_LENS_PI 3.14159265358979324
#endif

CLARAY_SHARED_BEGIN

/// Where the ray starts, in front of the position; the rest is in `ray`.
typedef struct LensRay {
    ProjectionRay ray;
    ProjectionReal from_forward;
} LensRay;

// Six squares side by side: +x -x +y -y +z -z, oriented as the faces of OpenGL's cubes. +x is the camera's right, +y
// its up, and it looks towards -z.
CLARAY_SHARED_FUNCTION ProjectionRay aim_cube(ProjectionReal x, ProjectionReal y, ProjectionReal half_width,
                                              ProjectionReal half_height) {
    (void)half_width, (void)half_height;
    const ProjectionReal at = 3 * (x + 1);
    const int face = at < 0 ? 0 : at < 5 ? (int)at : 5;
    const ProjectionReal s = 2 * (at - (ProjectionReal)face) - 1;
    ProjectionRay ray = {0, 0, s, y, -1};
    if (face == 0) ray.right = 1, ray.forward = s;
    if (face == 1) ray.right = -1, ray.forward = -s;
    if (face == 2) ray.up = 1, ray.forward = y;
    if (face == 3) ray.up = -1, ray.forward = -y;
    if (face == 5) ray.right = -s, ray.forward = 1;
    return ray;
}
CLARAY_SHARED_FUNCTION ProjectionPlace place_cube(ProjectionReal right, ProjectionReal up, ProjectionReal forward,
                                                  ProjectionReal half_width, ProjectionReal half_height) {
    (void)half_width, (void)half_height;
    const ProjectionReal across = fabs(right), upwards = fabs(up), along = fabs(forward);
    int face = forward < 0 ? 4 : 5;
    ProjectionReal s = (forward < 0 ? right : -right) / along, y = up / along;
    if (across >= upwards && across > along)
        face = right > 0 ? 0 : 1, s = (right > 0 ? forward : -forward) / across, y = up / across;
    else if (upwards > along)
        face = up > 0 ? 2 : 3, s = right / upwards, y = (up > 0 ? forward : -forward) / upwards;
    const ProjectionPlace place = {((ProjectionReal)(2 * face + 1) + s) / 6 - 1, y, 1};
    return place;
}

// Fisheyes: `half_width` and `half_height` scale the image. The distance from its centre is then the angle from the
// view (equidistant), or twice the sine of half the angle (equisolid: equal areas see equal solid angles).

CLARAY_SHARED_FUNCTION ProjectionReal lens_radius(ProjectionReal x, ProjectionReal y) { return sqrt(x * x + y * y); }

/// The ray at this angle from the view, whose image is at (x, y), `radius` from the centre.
CLARAY_SHARED_FUNCTION ProjectionRay lens_ray(ProjectionReal x, ProjectionReal y, ProjectionReal radius,
                                              ProjectionReal half_turns) {
    const ProjectionReal aside = radius > 0 ? claray_sine(half_turns) / radius : 1;
    const ProjectionRay ray = {0, 0, aside * x, aside * y, claray_cosine(half_turns)};
    return ray;
}
CLARAY_SHARED_FUNCTION ProjectionRay aim_fisheye(ProjectionReal x, ProjectionReal y, ProjectionReal half_width,
                                                 ProjectionReal half_height) {
    const ProjectionReal radius = lens_radius(x * half_width, y * half_height);
    return lens_ray(x, y, radius, fmin(radius / CLARAY_LENS_PI, (ProjectionReal)1));
}
CLARAY_SHARED_FUNCTION ProjectionRay aim_equisolid(ProjectionReal x, ProjectionReal y, ProjectionReal half_width,
                                                   ProjectionReal half_height) {
    const ProjectionReal radius = lens_radius(x * half_width, y * half_height);
    const ProjectionReal sine = fmin(radius / 2, (ProjectionReal)1), cosine = sqrt(1 - sine * sine);
    return lens_ray(x, y, radius, 2 * claray_half_turns(sine, cosine));
}
/// `scale`: radius over the length of (right, up) in the scene's units.
CLARAY_SHARED_FUNCTION ProjectionPlace lens_place(ProjectionReal right, ProjectionReal up, ProjectionReal scale) {
    const ProjectionPlace place = {scale * right, scale * up, 1};
    return place;
}
CLARAY_SHARED_FUNCTION ProjectionPlace place_fisheye(ProjectionReal right, ProjectionReal up, ProjectionReal forward,
                                                     ProjectionReal half_width, ProjectionReal half_height) {
    const ProjectionReal aside = lens_radius(right * half_width, up * half_height);
    const ProjectionReal angle = CLARAY_LENS_PI * claray_half_turns(aside, forward);
    return lens_place(right, up, aside > 0 ? angle / aside : 0);
}
CLARAY_SHARED_FUNCTION ProjectionPlace place_equisolid(ProjectionReal right, ProjectionReal up, ProjectionReal forward,
                                                       ProjectionReal half_width, ProjectionReal half_height) {
    const ProjectionReal aside = lens_radius(right * half_width, up * half_height);
    const ProjectionReal twice_sine = 2 * claray_sine(claray_half_turns(aside, forward) / 2);
    return lens_place(right, up, aside > 0 ? twice_sine / aside : 0);
}

CLARAY_SHARED_FUNCTION ProjectionRay aim_any(uint projection, ProjectionReal x, ProjectionReal y,
                                             ProjectionReal half_width, ProjectionReal half_height) {
#define CLARAY_AIM(name, NAME, text, flat, parallel, stretch)                        \
    if (CLARAY_USES_PROJECTION(NAME) && CLARAY_KIND_OF(projection) == CLARAY_##NAME) \
        return aim_##name(x, y, half_width, half_height);
    CLARAY_WIDE_PROJECTIONS(CLARAY_AIM)
#undef CLARAY_AIM
    return aim_ray(projection, x, y);
}

/// As place_in_image. A point has no single place in images of cameras with two eyes, shift or tilt.
CLARAY_SHARED_FUNCTION ProjectionPlace place_in_any(uint projection, ProjectionReal right, ProjectionReal up,
                                                    ProjectionReal forward, ProjectionReal half_width,
                                                    ProjectionReal half_height) {
    const ProjectionPlace none = {0, 0, 0};
    if (projection > CLARAY_KIND_BITS) return none;
#define CLARAY_PLACE(name, NAME, text, flat, parallel, stretch)      \
    if (CLARAY_USES_PROJECTION(NAME) && projection == CLARAY_##NAME) \
        return place_##name(right, up, forward, half_width, half_height);
    CLARAY_WIDE_PROJECTIONS(CLARAY_PLACE)
#undef CLARAY_PLACE
    return place_in_image(projection, right, up, forward);
}

/// The eye of a point of the image: -1 left, 1 right, 0 if the camera has one. (x, y) becomes the point of its own
/// image.
CLARAY_SHARED_FUNCTION ProjectionReal eye_at(uint projection, ProjectionReal* x, ProjectionReal* y) {
    ProjectionReal eye = 0;
    if ((projection & CLARAY_SIDE_BY_SIDE) != 0u) eye = *x < 0 ? -1 : 1, *x = 2 * *x - eye;
    if ((projection & CLARAY_TOP_BOTTOM) != 0u) eye = *y >= 0 ? -1 : 1, *y = 2 * *y + eye;
    return eye;
}

/// The ray through a point of the image. The eyes of a panorama are on a circle, beside each other as seen along the
/// ray (Google 2015, "Rendering Omni-directional Stereo Content"). Other eyes look along parallel axes.
CLARAY_SHARED_FUNCTION LensRay aim_lens(CameraData c, ProjectionReal x, ProjectionReal y) {
    const ProjectionReal eye = eye_at(c.projection, &x, &y) * c.CLARAY_LENS_EYE;
    if ((c.projection & CLARAY_SHIFTED) != 0u) x += c.CLARAY_LENS_SHIFT_X, y += c.CLARAY_LENS_SHIFT_Y;
    LensRay lens = {aim_any(c.projection, x, y, c.half_width, c.half_height), 0};
    if (eye == 0) return lens;
    if (CLARAY_KIND_OF(c.projection) == CLARAY_PANORAMA) {
        lens.ray.from_right = eye * claray_cosine(x);
        lens.from_forward = -eye * claray_sine(x);
        return lens;
    }
    lens.ray.from_right += eye / c.half_width;
    lens.ray.right -= eye * c.CLARAY_LENS_NEARNESS / c.half_width;
    return lens;
}

/// The distance along the view at which a ray is sharp.
CLARAY_SHARED_FUNCTION ProjectionReal focus_of(CameraData c, ProjectionRay ray) {
    if ((c.projection & CLARAY_TILTED) == 0u) return c.focus;
    return c.focus /
           (1 + c.CLARAY_LENS_TILT_X * ray.right * c.half_width + c.CLARAY_LENS_TILT_Y * ray.up * c.half_height);
}

CLARAY_SHARED_END

#else
#define place_in_any(projection, right, up, forward, half_width, half_height) \
    place_in_image(projection, right, up, forward)
#endif

#endif
