// Textures in device memory. One buffer of 32-bit words, the store, begins with a TextureStore and holds all data of
// textures. OpenCL images are not used: some devices lack them, and their filters are too coarse (8 bits of fraction)
// and differ between devices.
#ifndef CLARAY_SHARED_TEXTURE_H
#define CLARAY_SHARED_TEXTURE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

#define CLARAY_REPEAT 0u
#define CLARAY_MIRRORED 1u
#define CLARAY_CLAMPED 2u

#define CLARAY_NEAREST 0u
#define CLARAY_BILINEAR 1u
#define CLARAY_TRILINEAR 2u
#define CLARAY_NEAREST_LEVEL 3u

#define CLARAY_SRGB8 0u
#define CLARAY_LINEAR8 1u
#define CLARAY_FLOAT32 2u

/// Material parameters that a texture can set.
#define CLARAY_ALBEDO_MAP 0u
#define CLARAY_EMISSION_MAP 1u
#define CLARAY_METALLIC_ROUGHNESS_MAP 2u
#define CLARAY_TRANSMISSION_MAP 3u
#define CLARAY_CLEARCOAT_MAP 4u
#define CLARAY_CLEARCOAT_ROUGHNESS_MAP 5u
#define CLARAY_HEIGHT_MAP 6u  // applied before the normal map, which rotates the resulting normal
#define CLARAY_NORMAL_MAP 7u
#define CLARAY_LIGHT_MAP 8u
#define CLARAY_COMMON_MAPS 9  // the maps above are checked in every textured scene, those below only under LAYER_MAPS
#define CLARAY_SPECULAR_MAP 9u
#define CLARAY_SPECULAR_WEIGHT_MAP 10u
#define CLARAY_SHININESS_MAP 11u
#define CLARAY_SHEEN_MAP 12u
#define CLARAY_SHEEN_ROUGHNESS_MAP 13u
#define CLARAY_ANISOTROPY_MAP 14u
#define CLARAY_IRIDESCENCE_MAP 15u
#define CLARAY_FILM_THICKNESS_MAP 16u
#define CLARAY_COAT_NORMAL_MAP 17u
#define CLARAY_MAPS 18

#define CLARAY_NO_MAP 0xffffffffu
#define CLARAY_TEXTURE_LEVELS 15  // sides of 2^14 texels down to one

/// Begin of each section of the store, in words; 0: the section is absent.
typedef struct TextureStore {
    uint textures;   // TextureData
    uint uses;       // TextureUseData
    uint materials;  // MaterialMaps, one per material of the scene
    uint decode;     // floats: values of the 256 bytes for CLARAY_LINEAR8, then for CLARAY_SRGB8
    uint uvs[2];     // two floats per vertex
    uint tangents;   // four floats per vertex; 0 0 0 0 if the mesh has no tangents
    uint cutouts;    // one word per triangle: begin of its record (see CutoutMaterial), or CLARAY_NO_MAP if it is solid
    uint cutout_materials;  // CutoutMaterial
    uint colors;            // three floats per vertex; 1 1 1 if the mesh has no colours
    uint spare[2];
} TextureStore;
CLARAY_LAYOUT(TextureStore, 48)

/// Texels are stored row by row, as bytes (three channels are padded to four, so that a texel is a word) or as floats.
typedef struct TextureData {
    uint width, height;
    uint levels;                         // of the mip map; 1: the original image only
    uint channels;                       // 1 to 4: grey, grey and alpha, RGB, RGBA
    uint format, filter;                 // CLARAY_SRGB8 ..., CLARAY_NEAREST ...
    uint wrap_u, wrap_v;                 // CLARAY_REPEAT ...
    uint offset[CLARAY_TEXTURE_LEVELS];  // begin of each level, in words
    uint spare;
} TextureData;
CLARAY_LAYOUT(TextureData, 96)

/// How a material uses a texture: u' = m00 u + m01 v + m02, v' = m10 u + m11 v + m12.
typedef struct TextureUseData {
    float m00, m01, m02;
    float m10, m11, m12;
    uint texture;
    uint uv_set;  // 0 or 1
} TextureUseData;
CLARAY_LAYOUT(TextureUseData, 32)

/// The maps of a material, each the index of a TextureUseData or CLARAY_NO_MAP.
typedef struct MaterialMaps {
    uint use[CLARAY_MAPS];
    float normal_scale;
    float height_scale;
    float coat_normal_scale;
    uint spare[3];
} MaterialMaps;
CLARAY_LAYOUT(MaterialMaps, 96)

#define CLARAY_CUT_MASK 1u          // the surface exists where the opacity reaches the cut-off
#define CLARAY_CUT_BLEND 2u         // the surface exists with the opacity as probability
#define CLARAY_CUT_BACK 4u          // the surface does not exist for rays from behind
#define CLARAY_CUT_VERTEX_ALPHA 8u  // the opacity is multiplied by an alpha per corner
#define CLARAY_CUT_OUTSIDE 16u      // a mask exists outside its interval of opacities

/// Where rays pass through triangles. The record of such a triangle holds the index of its CutoutMaterial. Then the
/// alphas of the three corners if the mode has them, and the transformed coordinates of the three corners for each
/// texture that is used.
typedef struct CutoutMaterial {
    uint mode;              // CLARAY_CUT_...
    float opacity, cutoff;  // a mask exists where the opacity is from `cutoff` to `most`
    uint albedo;            // texture whose alpha multiplies the opacity, or CLARAY_NO_MAP
    uint opacity_map;       // texture whose red multiplies the opacity, or CLARAY_NO_MAP
    float most;
    uint spare[2];
} CutoutMaterial;
CLARAY_LAYOUT(CutoutMaterial, 32)

/// The footprint of a path: a cone around its ray (Akenine-Moeller et al. 2019, Ray Tracing Gems ch. 20).
typedef struct RayCone {
    float width;   // at the ray's origin
    float spread;  // increase of the width per unit of length
} RayCone;
CLARAY_LAYOUT(RayCone, 8)

CLARAY_SHARED_END

#endif
