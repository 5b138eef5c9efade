// The list of all effects of a scene. The host's effects, their names and the kernels' macros are made from it, and in kernels the
// conditions under which sixteen rays are worked on at once (docs/architecture.md).
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

// A row is X(name, "name for users", MACRO, bit, stages, lanes):
//   name    Effect::name
//   MACRO   the kernels' macro; `bit`: the effect's bit in its value
//   stages  whose kernels get the macro (host/effects/effects.hpp). Kernels that are compiled for no scene have code for all effects. none: the
//           structure that is traced brings the macro
//   lanes   CLARAY_LANES_...
// BSDF, LIGHT and PROJECTION take the rows of bsdfs.h, lights.h and projections.h. Texts name effects in this order.
// clang-format off
#define CLARAY_EFFECTS(X, BSDF, LIGHT, PROJECTION)                                           \
    CLARAY_CUSTOM_KINDS(BSDF)                                                                \
    X(smooth_normals, "smooth-normals", NORMALS, 0, shade | aovs, CLARAY_LANES_ALL)          \
    CLARAY_MATERIAL_KINDS(BSDF) CLARAY_HIT_KINDS(BSDF)                                       \
    X(transmission, "transmission", MATERIALS, CLARAY_GLASS, shade, CLARAY_LANES_ALL)        \
    X(rough_glass, "rough-glass", ROUGH_GLASS, 0, shade, CLARAY_LANES_ALL)                   \
    X(clearcoat, "clearcoat", CLEARCOAT, 0, shade, CLARAY_LANES_ALL)                         \
    X(layered_coat, "layered-coat", LAYERED_COAT, 0, shade, CLARAY_LANES_ALL)                \
    X(specular, "specular", SPECULAR, 0, shade, CLARAY_LANES_ALL)                            \
    X(iridescence, "iridescence", IRIDESCENCE, 0, shade, CLARAY_LANES_ALL)                   \
    X(anisotropy, "anisotropy", ANISOTROPY, 0, shade, CLARAY_LANES_ALL)                      \
    X(sheen, "sheen", SHEEN, 0, shade, CLARAY_LANES_ALL)                                     \
    X(absorption, "absorption", ABSORPTION, 0, shade, CLARAY_LANES_SHADE)                    \
    X(nested_media, "nested-media", NESTED_MEDIA, 0, shade, CLARAY_LANES_NONE)               \
    X(emissive_triangles, "emissive-triangles", TRIANGLE_LIGHTS, 0, shade, CLARAY_LANES_ALL) \
    CLARAY_LIGHT_KINDS(LIGHT)                                                                \
    X(light_falloff, "light-falloff", LIGHT_FALLOFF, 0, shade, CLARAY_LANES_LISTS)           \
    X(linear_ranges, "linear-ranges", LINEAR_RANGES, 0, shade, CLARAY_LANES_ALL)             \
    X(light_lists, "light-lists", LIGHT_LISTS, 0, shade, CLARAY_LANES_LISTS)                 \
    X(many_lights, "many-lights", LIGHT_TREE, 0, shade, CLARAY_LANES_ALL)                    \
    X(hot_spots, "hot-spots", HOT_SPOTS, 0, shade, CLARAY_LANES_ALL)                         \
    X(sky, "sky", SKY, 0, shade, CLARAY_LANES_ALL)                                           \
    X(environment, "environment", ENVIRONMENT, 0, shade, CLARAY_LANES_ALL)                   \
    X(depth_of_field, "depth-of-field", DEPTH_OF_FIELD, 0, generate, CLARAY_LANES_ALL)       \
    X(camera_motion, "camera-motion", CAMERA_MOTION, 0, generate, CLARAY_LANES_ALL)          \
    CLARAY_OTHER_PROJECTIONS(PROJECTION)                                                     \
    X(instances, "instances", INSTANCES, 0, none, CLARAY_LANES_NONE)                         \
    X(instance_motion, "instance-motion", INSTANCE_MOTION, 0, none, CLARAY_LANES_NONE)       \
    X(primitives, "primitives", PRIMITIVES, 0, none, CLARAY_LANES_LISTS)                     \
    X(vertex_colors, "vertex-colors", VERTEX_COLORS, 0, shade | aovs, CLARAY_LANES_NONE)     \
    X(textures, "textures", TEXTURES, 0, shade | aovs, CLARAY_LANES_NONE)                    \
    X(mip_maps, "mip-maps", MIPMAPS, 0, shade | aovs, CLARAY_LANES_LISTS)                    \
    X(nearest_levels, "nearest-levels", NEAREST_LEVELS, 0, shade | aovs, CLARAY_LANES_ALL)   \
    X(normal_maps, "normal-maps", NORMAL_MAPS, 0, shade | aovs, CLARAY_LANES_ALL)            \
    X(height_maps, "height-maps", HEIGHT_MAPS, 0, shade | aovs, CLARAY_LANES_ALL)            \
    X(emission_maps, "emission-maps", EMISSION_MAPS, 0, shade, CLARAY_LANES_ALL)             \
    X(cut_outs, "cut-outs", CUT_OUTS, 0, trace, CLARAY_LANES_ALL)                            \
    X(culling, "culling", CUT_OUTS, 1, trace, CLARAY_LANES_ALL)                              \
    X(light_maps, "light-maps", LIGHT_MAPS, 0, shade | aovs, CLARAY_LANES_ALL)
// clang-format on

#endif
