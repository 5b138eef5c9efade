// Materials, lights, camera and sky as the shading kernels read them.
#ifndef CLARAY_SHARED_SCENE_H
#define CLARAY_SHARED_SCENE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

#define CLARAY_LAMBERT 0u
#define CLARAY_MIRROR 1u
#define CLARAY_GLASS 2u
#define CLARAY_METAL 3u
#define CLARAY_BLINN_PHONG 4u
#define CLARAY_PRINCIPLED 5u

#define CLARAY_POINT_LIGHT 0u
#define CLARAY_DIRECTIONAL_LIGHT 1u
#define CLARAY_SPOT_LIGHT 2u

typedef struct MaterialData {
    float albedo_r, albedo_g, albedo_b;  // Lambert: albedo; mirror, metal: reflectance at normal incidence; glass: tint
    uint kind;                           // CLARAY_LAMBERT ...
    float emission_r, emission_g, emission_b;  // radiance, W / (m^2 sr)
    float roughness;                           // metal: alpha = roughness^2 (GGX)
    float ior;                                 // glass: index of refraction, inside over outside
} MaterialData;
CLARAY_LAYOUT(MaterialData, 36)

// All lights form one distribution, the triangles before the points, in which each is picked in proportion to its
// power: a random 32-bit number picks the first light whose `cumulative` is not below it.

/// An emissive triangle.
typedef struct TriangleLight {
    float v0x, v0y, v0z;
    float e1x, e1y, e1z;  // v1 - v0
    float e2x, e2y, e2z;  // v2 - v0
    float area;
    float emission_r, emission_g, emission_b;
    uint primitive;
    uint cumulative;    // 2^32 times the share of power of all lights up to and including this one, less 1
    float probability;  // of picking this light
} TriangleLight;
CLARAY_LAYOUT(TriangleLight, 64)

typedef struct PointLightData {
    float x, y, z;
    float intensity_r, intensity_g, intensity_b;  // radiant intensity, W / sr
    uint cumulative;                              // as in TriangleLight
    float probability;
} PointLightData;
CLARAY_LAYOUT(PointLightData, 32)

/// A pinhole camera or a thin lens, as the shutter opens. `right` and `up` span half the image plane at distance 1 along
/// `forward`. What follows `aperture` is read under DEPTH_OF_FIELD, what follows `move` under CAMERA_MOTION.
typedef struct CameraData {
    float x, y, z;
    float forward_x, forward_y, forward_z;
    float right_x, right_y, right_z;
    float up_x, up_y, up_z;
    float aperture;                           // radius of the lens; 0: a pinhole
    float focus;                              // distance of the sharp plane along `forward`; 0: the target's, in motion
    float move_x, move_y, move_z;             // of the position until the shutter closes
    float view_x, view_y, view_z;             // from the position to the target, as the shutter opens
    float view_move_x, view_move_y, view_move_z;  // its change until the shutter closes
    float above_x, above_y, above_z;          // unit direction that is up in the image
    float half_width, half_height;            // lengths of `right` and `up`
} CameraData;
CLARAY_LAYOUT(CameraData, 112)

/// Radiance from where no surface is: from `horizon` (direction.y <= 0) to `zenith` (direction.y = 1), linear in y.
typedef struct SkyData {
    float horizon_r, horizon_g, horizon_b;
    float zenith_r, zenith_g, zenith_b;
} SkyData;
CLARAY_LAYOUT(SkyData, 24)

CLARAY_SHARED_END

#endif
