// The list of all effects of a scene. The host's effects, their names and the kernels' macros are made from it, and in
// kernels the conditions under which sixteen rays are worked on at once (docs/architecture.md).
#ifndef CLARAY_SHARED_LISTS_EFFECTS_H
#define CLARAY_SHARED_LISTS_EFFECTS_H

#include "claray/shared/lists/bsdfs.h"
#include "claray/shared/lists/lights.h"
#include "claray/shared/lists/projections.h"

// Bits of `lanes`: what works on sixteen rays at once although the scene has the effect.
#define CLARAY_LANES_NONE 0
#define CLARAY_LANES_SHADE 1  // shading of plain surfaces (render/shade_sixteen.clh)
#define CLARAY_LANES_LISTS 2  // plain surfaces that ask lists for a light (shade/surface_sixteen.clh)
#define CLARAY_LANES_ALL 3

// Bits of `traits`: what the renderer must know of an effect.
#define CLARAY_OF_BSDF 1  // only the BSDFs of single materials need it
#define CLARAY_SAMPLED 2  // a light that shadow rays find
#define CLARAY_EMITS 4    // the end of a path may meet its light
#define CLARAY_AID 8      // it changes the noise of an image but not its limit; no part of the scene needs it

// A row is X(name, "name for users", MACRO, bit, stages, lanes, traits):
//   name    Effect::name
//   MACRO   the kernels' macro; `bit`: the effect's bit in its value
//   stages  whose kernels get the macro (host/effects/effects.hpp). Kernels that are compiled for no scene have code
//           for all effects. none: the structure that is traced brings the macro
//   lanes   CLARAY_LANES_...
//   traits  CLARAY_OF_BSDF, ...; 0: none
// BSDF, LIGHT and PROJECTION take the rows of bsdfs.h, lights.h and projections.h. Texts name effects in this order.
// clang-format off
#define CLARAY_EFFECTS(X, BSDF, LIGHT, PROJECTION)                                                                          \
    CLARAY_CUSTOM_KINDS(BSDF)                                                                                               \
    X(smooth_normals, "smooth-normals", NORMALS, 0, shade | aovs, CLARAY_LANES_ALL, 0)                                      \
    CLARAY_MATERIAL_KINDS(BSDF) CLARAY_HIT_KINDS(BSDF)                                                                      \
    X(transmission, "transmission", MATERIALS, CLARAY_GLASS, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                       \
    X(rough_glass, "rough-glass", ROUGH_GLASS, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                                  \
    X(clearcoat, "clearcoat", CLEARCOAT, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                                        \
    X(layered_coat, "layered-coat", LAYERED_COAT, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                               \
    X(specular, "specular", SPECULAR, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                                           \
    X(iridescence, "iridescence", IRIDESCENCE, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                                  \
    X(anisotropy, "anisotropy", ANISOTROPY, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                                     \
    X(sheen, "sheen", SHEEN, 0, shade, CLARAY_LANES_ALL, CLARAY_OF_BSDF)                                                    \
    X(absorption, "absorption", ABSORPTION, 0, shade, CLARAY_LANES_SHADE, 0)                                                \
    X(nested_media, "nested-media", NESTED_MEDIA, 0, shade, CLARAY_LANES_NONE, 0)                                           \
    X(fog, "fog", FOG, 0, shade, CLARAY_LANES_NONE, CLARAY_EMITS)                                                           \
    X(emissive_triangles, "emissive-triangles", TRIANGLE_LIGHTS, 0, shade, CLARAY_LANES_ALL, CLARAY_SAMPLED | CLARAY_EMITS) \
    CLARAY_LIGHT_KINDS(LIGHT)                                                                                               \
    X(light_falloff, "light-falloff", LIGHT_FALLOFF, 0, shade, CLARAY_LANES_ALL, 0)                                         \
    X(linear_ranges, "linear-ranges", LINEAR_RANGES, 0, shade, CLARAY_LANES_ALL, 0)                                         \
    X(light_lists, "light-lists", LIGHT_LISTS, 0, shade, CLARAY_LANES_LISTS, CLARAY_AID)                                    \
    X(many_lights, "many-lights", LIGHT_TREE, 0, shade, CLARAY_LANES_ALL, CLARAY_AID)                                       \
    X(hot_spots, "hot-spots", HOT_SPOTS, 0, shade, CLARAY_LANES_ALL, CLARAY_AID)                                            \
    X(sky, "sky", SKY, 0, shade, CLARAY_LANES_ALL, CLARAY_EMITS)                                                            \
    X(environment, "environment", ENVIRONMENT, 0, shade, CLARAY_LANES_ALL, CLARAY_SAMPLED | CLARAY_EMITS)                   \
    X(depth_of_field, "depth-of-field", DEPTH_OF_FIELD, 0, generate, CLARAY_LANES_ALL, 0)                                   \
    X(camera_motion, "camera-motion", CAMERA_MOTION, 0, generate, CLARAY_LANES_ALL, 0)                                      \
    CLARAY_OTHER_PROJECTIONS(PROJECTION)                                                                                    \
    X(stereo, "stereo", PROJECTIONS, CLARAY_STEREO, generate | shade, CLARAY_LANES_ALL, 0)                                  \
    X(lens_shift, "lens-shift", PROJECTIONS, CLARAY_SHIFT, generate | shade, CLARAY_LANES_ALL, 0)                           \
    X(tilted_focus, "tilted-focus", PROJECTIONS, CLARAY_TILT, generate | shade, CLARAY_LANES_ALL, 0)                        \
    X(instances, "instances", INSTANCES, 0, none, CLARAY_LANES_NONE, 0)                                                     \
    X(instance_motion, "instance-motion", INSTANCE_MOTION, 0, none, CLARAY_LANES_NONE, 0)                                   \
    X(primitives, "primitives", PRIMITIVES, 0, none, CLARAY_LANES_LISTS, 0)                                                 \
    X(vertex_colors, "vertex-colors", VERTEX_COLORS, 0, shade | aovs, CLARAY_LANES_NONE, 0)                                 \
    X(textures, "textures", TEXTURES, 0, shade | aovs, CLARAY_LANES_SHADE, 0)                                               \
    X(mip_maps, "mip-maps", MIPMAPS, 0, shade | aovs, CLARAY_LANES_ALL, 0)                                                  \
    X(nearest_levels, "nearest-levels", NEAREST_LEVELS, 0, shade | aovs, CLARAY_LANES_ALL, 0)                               \
    X(normal_maps, "normal-maps", NORMAL_MAPS, 0, shade | aovs, CLARAY_LANES_ALL, 0)                                        \
    X(height_maps, "height-maps", HEIGHT_MAPS, 0, shade | aovs, CLARAY_LANES_ALL, 0)                                        \
    X(emission_maps, "emission-maps", EMISSION_MAPS, 0, shade, CLARAY_LANES_ALL, 0)                                         \
    X(cut_outs, "cut-outs", CUT_OUTS, 0, trace, CLARAY_LANES_ALL, 0)                                                        \
    X(culling, "culling", CUT_OUTS, 1, trace, CLARAY_LANES_ALL, 0)                                                          \
    X(light_maps, "light-maps", LIGHT_MAPS, 0, shade | aovs, CLARAY_LANES_ALL, CLARAY_EMITS)
// clang-format on

#endif
