// Materials, lights, camera, sky and primitives in the form that shading kernels read.
#ifndef CLARAY_SHARED_SCENE_H
#define CLARAY_SHARED_SCENE_H

#include "claray/shared/lists/bsdfs.h"
#include "claray/shared/lists/lights.h"
#include "claray/shared/lists/sky.h"
#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

// Layers of a principled material: bits of MaterialData::layers.
#define CLARAY_SPECULAR_LAYER 1u     // the dielectric's reflection is changed (KHR_materials_specular)
#define CLARAY_FILM_LAYER 2u         // iridescence
#define CLARAY_SHEEN_LAYER 4u        // fibres above everything except a coat
#define CLARAY_ANISOTROPIC_LAYER 8u  // stretched highlights
#define CLARAY_COAT_LAYER 16u        // a coat with its own normal
#define CLARAY_PLAIN_COAT 32u        // set at a hit: a coat over a diffuse dielectric

typedef struct MaterialData {
    float albedo_r, albedo_g, albedo_b;        // see Material::albedo
    uint kind;                                 // claray/shared/lists/bsdfs.h
    float emission_r, emission_g, emission_b;  // radiance, W / (m^2 sr)
    float roughness;                           // alpha = roughness^2 (GGX)
    float ior;                                 // index of refraction, inside over outside
    float sampled_emission;  // luminance for sampling its triangles; 0: not sampled; < 0: each triangle has its own
    float metallic, transmission;                    // principled
    float clearcoat, clearcoat_roughness;            // principled
    float specular_r, specular_g, specular_b;        // Blinn-Phong: specular + albedo <= 1; principled: the tint
    float absorption_r, absorption_g, absorption_b;  // inside, per unit of length
    uint energy, coat_energy;  // begin of the tables of its ior and of its coat in the energy tables
    uint thin_walled;          // principled
    // The following members are read only if their own macros are set.
    uint layers;  // CLARAY_SPECULAR_LAYER ...; resolve_principled clears the layers that a hit does not have
    float specular_weight;
    float sheen_r, sheen_g, sheen_b, sheen_roughness;
    float anisotropy, anisotropy_rotation;
    float iridescence, film_ior;
    float film_thickness, film_thickness_min;  // nanometres; at a hit, the first is the thickness there
    float coat_x, coat_y, coat_z;              // normal of the coat at a hit, in the local frame
    uint custom;                               // number of the added BSDF; `energy` is where its parameters begin
    uint maps;                                 // bits of CLARAY_ALBEDO_MAP and so on
    uint shader;  // number of the kernel that shades it, if the scene's materials have several
#define CLARAY_MEMBER(name, text, standard, check) float name;
    CLARAY_BSDF_PARAMETERS(CLARAY_MEMBER)
#undef CLARAY_MEMBER
} MaterialData;
#define CLARAY_MEMBER_SIZE(name, text, standard, check) +4
CLARAY_LAYOUT(MaterialData, 164 CLARAY_BSDF_PARAMETERS(CLARAY_MEMBER_SIZE))

// Lights are numbered: emissive triangles, near lights, far lights (lights.h), the environment. A random 32-bit
// number selects the first light whose `cumulative` is not below it; if there is none, the environment. If a light tree
// exists, numbers up to LightsData::tree_last select the tree instead; if a grid exists, those up to grid_last select
// the grid.

/// An emissive triangle.
typedef struct TriangleLight {
    float v0x, v0y, v0z;
    float e1x, e1y, e1z;                       // v1 - v0
    float e2x, e2y, e2z;                       // v2 - v0
    float area;                                // negative: emits from the front only
    float emission_r, emission_g, emission_b;  // textured: the average
    uint primitive;
    uint cumulative;    // 2^32 times the share of power of all lights up to and including this one, minus 1
    float probability;  // of selecting this light
} TriangleLight;
CLARAY_LAYOUT(TriangleLight, 64)

/// A light of lights.h.
typedef struct PunctualLight {
    float x, y, z;                                // position; not used by far lights
    float intensity_r, intensity_g, intensity_b;  // radiant intensity, W / sr; far: irradiance, W / m^2
    uint cumulative;                              // as in TriangleLight
    float probability;
    float direction_x, direction_y,
        direction_z;                // of emission, unit length; points: direction to the near surface
    uint kind;                      // claray/shared/lists/lights.h
    float cone_scale, cone_offset;  // cones: clamp(cosine * scale + offset, 0, 1)^2; point: the scale is
                                    // HotSpot::probability, 0 if no surface is near
    float inverse_range;            // 0: unlimited; negative: the range ends linearly (LINEAR_RANGES)
    float attenuation_0, attenuation_1, attenuation_2;
} PunctualLight;
CLARAY_LAYOUT(PunctualLight, 72)

#define CLARAY_TURNED_LAMP 0x80000000u  // for a textured triangle light: second and third vertex are exchanged

#define CLARAY_LIGHT_TREE_WIDTH 4
#define CLARAY_LIGHT_TREE_HEIGHT 16    // a trail of 32 bits holds the child of each level
#define CLARAY_LIGHT_LEAF 0x80000000u  // the child is the light with this number
#define CLARAY_TWO_SIDED_CONE 2.0f

/// The data of a light tree's node about its children. A sphere contains the lights of a child. A cone
/// contains their main directions of emission. Then their longest range, and their intensity in these directions.
/// Missing children have intensity 0. Each child owns a part of the 2^32 random numbers, in proportion to its
/// intensity: `span` numbers, from `first` on.
typedef struct LightNode {
    float x[4], y[4], z[4];
    float radius[4];  // negative: the lights differ in more than intensity even from far away
    float axis_x[4], axis_y[4], axis_z[4];
    float cos_spread[4], sin_spread[4];  // of the angle between the cone's axis and its border
    float cos_reach[4];                  // emission angle beyond that border; two-sided if CLARAY_TWO_SIDED_CONE
    float cone_scale[4];                 // of the steepest cone, as in PunctualLight; 0: not only cones
    float near_range[4];                 // 1 / the longest range; 0: unlimited
    float intensity[4];
    uint child[4];  // index of a node, or CLARAY_LIGHT_LEAF
    uint first[4], span[4];
} LightNode;
CLARAY_LAYOUT(LightNode, 256)

/// A light in the order of the tree's leaves, and its part of the 2^32 numbers. Leaf i of n also holds the start of the
/// search for numbers from i 2^32 / n on (Chen and Asau 1974, "On generating random variates from an empirical
/// distribution").
typedef struct LightLeaf {
    uint light;
    uint first, last;
    uint start;  // the leaf that owns the first of these numbers
} LightLeaf;
CLARAY_LAYOUT(LightLeaf, 16)

/// A grid of cubic cells over what lights with a range reach. In its table the starts of the cells' lists follow, that
/// of the list of what is outside the grid, its end, and then the lists: indices from LightsData::first_listed on.
typedef struct LightLists {
    float x, y, z;  // its corner
    float cells_per_length;
    uint width, height, depth;  // cells; x varies first, then y
    uint lights;
} LightLists;
CLARAY_LAYOUT(LightLists, 32)

/// Position of a triangle light in the tree. Stored in the order of the triangle lights.
typedef struct LightTrail {
    uint primitive;
    uint trail;  // child on each level, two bits each, the lowest level first
    uint leaf;   // index in the order of the leaves
} LightTrail;
CLARAY_LAYOUT(LightTrail, 12)

/// A point light so close to a surface that paths rarely find its light there (lights/light_hot_spot.clh). A random
/// number selects the first hot spot whose `last` is not below it, or none.
typedef struct HotSpot {
    uint last;  // 2^32 times the sum of probabilities up to and including this one, minus 1
    float probability;
    uint light;
    uint trail, leaf;  // as in LightTrail, if there is a tree
} HotSpot;
CLARAY_LAYOUT(HotSpot, 20)

/// Equal parts of 0..1 for each of which the search in a cumulative distribution has a start (guide tables: Chen and
/// Asau 1974). A power of two, so that no rounding moves a number to another part. The starts of the parts, and an end,
/// follow the numbers of a distribution as floats.
#define CLARAY_CDF_PARTS 256u
#define CLARAY_CDF_WORDS(count) ((count) + CLARAY_CDF_PARTS + 1u)

/// Share of its luminance by which a direction of an environment is sampled at least.
#define CLARAY_LEAST_SAMPLED 0.1f

/// An environment image in latitude and longitude, and the data for sampling its directions (lights/environment.clh).
typedef struct EnvironmentData {
    uint width, height;  // 0: no environment
    float turn;          // added to the column's coordinate, which is in 0..1
    float baseline;      // luminance up to which directions are mostly left to BSDF sampling
    float density;       // per steradian and per weight over the sine
    float probability;   // of sampling the environment instead of another light
} EnvironmentData;
CLARAY_LAYOUT(EnvironmentData, 24)

/// Number of lights and how they are selected.
typedef struct LightsData {
    uint triangles;  // emissive triangles; they come first
    uint near;       // triangles, points and spots: the lights of the tree, if there is one
    uint count;      // all lights, including the environment
    float density;   // of sampling a point on a triangle: probability per area and per luminance of its radiance
    uint tree_last;
    float tree_probability;  // 0: no tree
    uint grid_last;          // lights up to this random number are picked from the grid
    float grid_probability;  // 0: no grid
    uint first_listed;       // of the grid's lights, in the array of PunctualLight; they are not among `count`
    float instance_error;    // error of rays to lights that are instances, per distance from the object's origin
    float instance_reach;    // largest distance of the lights from that origin. Both are read only under INSTANCES
    uint hot_spots;          // 0: none
    float not_to_hot_spots;  // share of scattered rays that are not aimed at a hot spot
    EnvironmentData environment;
} LightsData;
CLARAY_LAYOUT(LightsData, 76)

/// A pinhole camera or a thin lens, at shutter open. `right` and `up` span half the image plane at distance 1 along
/// `forward`. For an orthographic camera they span half the image plane through the position, where its rays start. The
/// members after `aperture` are read under DEPTH_OF_FIELD, those after `move` under CAMERA_MOTION. The last is read
/// where PROJECTIONS is not 0.
typedef struct CameraData {
    float x, y, z;
    float forward_x, forward_y, forward_z;
    float right_x, right_y, right_z;
    float up_x, up_y, up_z;
    float aperture;                // radius of the lens; 0: a pinhole
    float focus;                   // distance of the sharp plane along `forward`; 0: that of the moving target
    float move_x, move_y, move_z;  // motion of the position until shutter close
    float view_x, view_y, view_z;  // from the position to the target, at shutter open
    float view_move_x, view_move_y, view_move_z;  // change of `view` until shutter close
    float above_x, above_y, above_z;              // unit vector: up in the image
    float half_width, half_height;                // lengths of `right` and `up`
    uint projection;                              // CLARAY_PERSPECTIVE, ... (claray/shared/lists/projections.h)
} CameraData;
CLARAY_LAYOUT(CameraData, 116)

/// See claray/shared/lists/sky.h.
typedef struct SkyData {
#define CLARAY_COLOR(name, text) float name##_r, name##_g, name##_b;
#define CLARAY_NUMBER(name, text) float name;
    CLARAY_SKY(CLARAY_COLOR, CLARAY_NUMBER)
#undef CLARAY_COLOR
#undef CLARAY_NUMBER
} SkyData;
#define CLARAY_COLOR_SIZE(name, text) +12
#define CLARAY_NUMBER_SIZE(name, text) +4
CLARAY_LAYOUT(SkyData, 0 CLARAY_SKY(CLARAY_COLOR_SIZE, CLARAY_NUMBER_SIZE))

// The kinds of claray::PrimitiveSet. Kernels are compiled for a set of them: bits of the macro PRIMITIVES.
#define CLARAY_SPHERES 0u
#define CLARAY_DISCS 1u
#define CLARAY_CYLINDERS 2u
#define CLARAY_CURVES 3u
#define CLARAY_BEZIER_CURVES 4u
#define CLARAY_FLAT_CURVES 5u
#define CLARAY_FLAT_BEZIER_CURVES 6u
#define CLARAY_PRIMITIVE_KINDS 7u

/// The beginning of the buffer that holds the primitives of a scene. Their numbers in hits follow those of the
/// triangles, kind after kind.
typedef struct PrimitiveStore {
    uint first[8];  // number of the first primitive of each kind, and one more than the last number
    uint data[7];   // the word where the data of each kind begins, in the form of kernels/primitives
    uint colors;    // the word where the colours begin, 0: none. Six floats per primitive: RGB at u = 0 and at u = 1
} PrimitiveStore;
CLARAY_LAYOUT(PrimitiveStore, 64)

CLARAY_SHARED_END

#endif
