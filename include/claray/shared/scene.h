// Materials, lights, camera and sky as the shading kernels read them.
#ifndef CLARAY_SHARED_SCENE_H
#define CLARAY_SHARED_SCENE_H

#include "claray/shared/bsdfs.h"
#include "claray/shared/lights.h"
#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

// Layers of a principled material, bits of MaterialData::layers.
#define CLARAY_SPECULAR_LAYER 1u     // its dielectric reflects otherwise than its index of refraction says
#define CLARAY_FILM_LAYER 2u         // iridescence
#define CLARAY_SHEEN_LAYER 4u        // fibres over everything but a coat
#define CLARAY_ANISOTROPIC_LAYER 8u  // highlights are stretched
#define CLARAY_COAT_LAYER 16u        // a coat with a normal of its own
#define CLARAY_PLAIN_COAT 32u        // set at a hit: a coat over a diffuse dielectric

typedef struct MaterialData {
    float albedo_r, albedo_g, albedo_b;        // see Material::albedo
    uint kind;                                 // claray/shared/bsdfs.h
    float emission_r, emission_g, emission_b;  // radiance, W / (m^2 sr)
    float roughness;                           // alpha = roughness^2 (GGX)
    float ior;                                 // index of refraction, inside over outside
    float sampled_emission;  // luminance by which its triangles are sampled; 0: they are not; < 0: each by its own
    float metallic, transmission;                    // principled
    float clearcoat, clearcoat_roughness;            // principled
    float specular_r, specular_g, specular_b;        // Blinn-Phong: specular + albedo <= 1; principled: the tint
    float absorption_r, absorption_g, absorption_b;  // inside, per unit of length
    uint energy, coat_energy;  // where the blocks of its ior and of its coat begin in the energy tables
    uint thin_walled;          // principled
    // What follows is read under macros of its own.
    uint layers;  // CLARAY_SPECULAR_LAYER ...; resolve_principled takes away what a hit does not have
    float specular_weight;
    float sheen_r, sheen_g, sheen_b, sheen_roughness;
    float anisotropy, anisotropy_rotation;
    float iridescence, film_ior;
    float film_thickness, film_thickness_min;  // nanometres; at a hit the first is its thickness
    float coat_x, coat_y, coat_z;              // the coat's normal at a hit, in the local frame
    uint spare;
#define CLARAY_MEMBER(name, text, standard, check) float name;
    CLARAY_BSDF_PARAMETERS(CLARAY_MEMBER)
#undef CLARAY_MEMBER
} MaterialData;
#define CLARAY_MEMBER_SIZE(name, text, standard, check) +4
CLARAY_LAYOUT(MaterialData, 156 CLARAY_BSDF_PARAMETERS(CLARAY_MEMBER_SIZE))

// Lights are numbered: emissive triangles, near lights of lights.h, far ones, the environment. A random 32-bit
// number picks the first one whose `cumulative` is not below it, the environment if there is none; where there is a
// tree, numbers up to LightsData::tree_last go there instead.

/// An emissive triangle.
typedef struct TriangleLight {
    float v0x, v0y, v0z;
    float e1x, e1y, e1z;                       // v1 - v0
    float e2x, e2y, e2z;                       // v2 - v0
    float area;                                // negative where it shines to the front alone
    float emission_r, emission_g, emission_b;  // of textured ones the average
    uint primitive;
    uint cumulative;    // 2^32 times the share of power of all lights up to and including this one, less 1
    float probability;  // of picking this light
} TriangleLight;
CLARAY_LAYOUT(TriangleLight, 64)

/// A light of lights.h.
typedef struct PunctualLight {
    float x, y, z;                                // position; not of far ones
    float intensity_r, intensity_g, intensity_b;  // radiant intensity, W / sr; far: irradiance, W / m^2
    uint cumulative;                              // as in TriangleLight
    float probability;
    float direction_x, direction_y,
        direction_z;                // in which it shines, unit length; points: way to the surface that is near
    uint kind;                      // claray/shared/lights.h
    float cone_scale, cone_offset;  // cones: clamp(cosine * scale + offset, 0, 1)^2; of points the scale is
                                    // HotSpot::probability, 0 where nothing is near
    float inverse_range;            // 0: unlimited
    float attenuation_0, attenuation_1, attenuation_2;
} PunctualLight;
CLARAY_LAYOUT(PunctualLight, 72)

#define CLARAY_TURNED_LAMP \
    0x80000000u  // of a triangle light with an image: second and third vertex have changed places

#define CLARAY_LIGHT_TREE_WIDTH 4
#define CLARAY_LIGHT_TREE_HEIGHT 16    // a trail of 32 bits says which child on each level
#define CLARAY_LIGHT_LEAF 0x80000000u  // a child that is the light of that number
#define CLARAY_TWO_SIDED_CONE 2.0f

/// What a node of the light tree knows about its children: a sphere that holds a child's lights, a cone that holds the
/// directions in which they shine most, and their intensity there. Missing children have none. Of 2^32 numbers, which
/// are handed out in proportion to intensity, a child's lights have those from `first` on, `span` of them.
typedef struct LightNode {
    float x[4], y[4], z[4];
    float radius[4];  // negative: other things than intensity tell its lights apart even from far away
    float axis_x[4], axis_y[4], axis_z[4];
    float cos_spread[4], sin_spread[4];  // of the angle between the cone's axis and its border
    float cos_reach[4];  // how far from that border light reaches; two-sided where CLARAY_TWO_SIDED_CONE
    float intensity[4];
    uint child[4];  // index of a node, or CLARAY_LIGHT_LEAF
    uint first[4], span[4];
} LightNode;
CLARAY_LAYOUT(LightNode, 224)

/// A light in the order of the tree's leaves, and its share of the 2^32 numbers. Leaf i of n also tells where to look
/// for the numbers from i 2^32 / n on (Chen and Asau 1974, "On generating random variates from an empirical
/// distribution").
typedef struct LightLeaf {
    uint light;
    uint first, last;
    uint start;  // the leaf that has the first of those numbers
} LightLeaf;
CLARAY_LAYOUT(LightLeaf, 16)

/// Where in the tree a triangle light is. In the order of the triangle lights.
typedef struct LightTrail {
    uint primitive;
    uint trail;  // which child to take on each level, two bits each, the lowest first
    uint leaf;   // its place in the order of the leaves
} LightTrail;
CLARAY_LAYOUT(LightTrail, 12)

/// A point light so close to a surface that paths seldom come upon its light there (lights/light_hot_spot.clh). The
/// first whose `last` is not below a random number is chosen, none if there is none.
typedef struct HotSpot {
    uint last;  // 2^32 times the probabilities up to and including this one's, less 1
    float probability;
    uint light;
    uint trail, leaf;  // as in LightTrail, where there is a tree
} HotSpot;
CLARAY_LAYOUT(HotSpot, 20)

/// An image of latitudes and longitudes round the scene, and how its directions are sampled (lights/environment.clh).
typedef struct EnvironmentData {
    uint width, height;  // 0: there is none
    float turn;          // added to the column's coordinate, which goes from 0 to 1
    float density;       // per steradian and per weight over the sine
    float probability;   // of sampling the environment rather than another light
} EnvironmentData;
CLARAY_LAYOUT(EnvironmentData, 20)

/// How many lights there are and how they are picked.
typedef struct LightsData {
    uint triangles;  // they come first
    uint near;       // triangles, points and spots: what the tree holds, if there is one
    uint count;      // of all, the environment included
    float density;   // probability per area, and per luminance of its radiance, of sampling a point on a triangle
    uint tree_last;
    float tree_probability;  // 0: there is no tree
    float instance_error;    // of a ray that goes to a light which is an instance, relative to the distance from the
    float instance_reach;    // object's origin; and how far from that the lights are. Read under INSTANCES only
    uint hot_spots;          // 0: there is none
    float not_to_hot_spots;  // the share of scattered rays that do not go to one
    EnvironmentData environment;
} LightsData;
CLARAY_LAYOUT(LightsData, 60)

/// A pinhole camera or a thin lens, as the shutter opens. `right` and `up` span half the image plane at distance 1
/// along `forward`; of an orthographic camera, half the image plane through the position, where its rays begin. What
/// follows `aperture` is read under DEPTH_OF_FIELD, what follows `move` under CAMERA_MOTION, the last under
/// ORTHOGRAPHIC.
typedef struct CameraData {
    float x, y, z;
    float forward_x, forward_y, forward_z;
    float right_x, right_y, right_z;
    float up_x, up_y, up_z;
    float aperture;                // radius of the lens; 0: a pinhole
    float focus;                   // distance of the sharp plane along `forward`; 0: the target's, in motion
    float move_x, move_y, move_z;  // of the position until the shutter closes
    float view_x, view_y, view_z;  // from the position to the target, as the shutter opens
    float view_move_x, view_move_y, view_move_z;  // its change until the shutter closes
    float above_x, above_y, above_z;              // unit direction that is up in the image
    float half_width, half_height;                // lengths of `right` and `up`
    uint orthographic;                            // 1: all rays go along `forward`
} CameraData;
CLARAY_LAYOUT(CameraData, 116)

/// Radiance from where no surface is: from `horizon` (direction.y <= 0) to `zenith` (direction.y = 1), linear in y.
typedef struct SkyData {
    float horizon_r, horizon_g, horizon_b;
    float zenith_r, zenith_g, zenith_b;
} SkyData;
CLARAY_LAYOUT(SkyData, 24)

CLARAY_SHARED_END

#endif
