// The list of the lobes by which the first surface of a path sends light to the camera. The layers of a render, their
// names and their places in kernels are made from it (kernels/render/layers/light_layers.clh, docs/architecture.md).
#ifndef CLARAY_SHARED_LISTS_LOBES_H
#define CLARAY_SHARED_LISTS_LOBES_H

#include "claray/shared/path.h"

// A row is X(name, NAME, "meaning"): the number is CLARAY_NAME, the layer is lobe_name. Behind a lobe of direct light
// follows that of indirect light.
#define CLARAY_LOBES(X)                                                                               \
    X(emission, EMISSION_LOBE, "what the first surface emits, with light maps and fog before it")     \
    X(environment, ENVIRONMENT_LOBE, "what the camera sees of sky, environment and suns")             \
    X(diffuse_direct, DIFFUSE_LOBE, "light of lamps and sky that it reflects diffusely")              \
    X(diffuse_indirect, INDIRECT_DIFFUSE_LOBE, "light of other surfaces that it reflects diffusely")  \
    X(glossy_direct, GLOSSY_LOBE, "light of lamps and sky that it mirrors, coats and sheen included") \
    X(glossy_indirect, INDIRECT_GLOSSY_LOBE, "light of other surfaces that it mirrors")               \
    X(transmission_direct, TRANSMISSION_LOBE, "light of lamps and sky that passes through it")        \
    X(transmission_indirect, INDIRECT_TRANSMISSION_LOBE, "light of other surfaces that passes through it")

enum {
#define CLARAY_ROW(name, NAME, meaning) CLARAY_##NAME,
    CLARAY_LOBES(CLARAY_ROW)
#undef CLARAY_ROW
        CLARAY_LOBE_COUNT
};

CLARAY_SHARED_BEGIN

/// How the first surface of a path sends the light of later ones to the camera.
typedef struct FirstLobe {
    float diffuse_r, diffuse_g, diffuse_b;  // the part that it reflects diffusely
    uint transmits;                         // 1: the path goes through the surface
} FirstLobe;
CLARAY_LAYOUT(FirstLobe, 16)

/// The light of a shadow ray: by which lobe it is sent, and in which layer of a group of lights it counts.
typedef struct LobeSample {
    float diffuse_r, diffuse_g, diffuse_b;
    uint transmits, indirect;
    uint group;  // 0: none
} LobeSample;
CLARAY_LAYOUT(LobeSample, 24)

/// The beginning of the table of layers. Behind it are the groups of materials, of triangle lights and of the other
/// lights: 0 for none, else from 1 on.
typedef struct LayerTable {
    uint words;                           // of all of the table
    uint lobes;                           // layers of lobes: CLARAY_LOBE_COUNT or 0
    uint groups;                          // layers of groups
    uint of_sky;                          // group of sky and environment
    uint materials, triangles, punctual;  // where the groups of each begin, in words
} LayerTable;
CLARAY_LAYOUT(LayerTable, 28)

// The buffer of radiance goes on, behind so many floats per path, with the table, the layers, and a FirstLobe and a
// LobeSample of each path.
#define CLARAY_FLOATS_BEFORE_LAYERS (6u + 3u * CLARAY_GUIDE_LESSONS)
#define CLARAY_LAYER_FLOATS 3u
#define CLARAY_FLOATS_BEHIND_LAYERS 10u

CLARAY_SHARED_END

#endif
