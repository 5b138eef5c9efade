// The list of a scene's tables, which lie in one buffer. The members of SceneTables are made from it.
#ifndef CLARAY_SHARED_LISTS_TABLES_H
#define CLARAY_SHARED_LISTS_TABLES_H

// A row is X(name); its comment says what the table consists of.
// clang-format off
#define CLARAY_TABLES(X)                                             \
    X(normals)            /* float, 3 per vertex */                  \
    X(triangle_materials) /* uint */                                 \
    X(materials)          /* MaterialData */                         \
    X(media_ranks)        /* uint, 1 per material: the rank of its medium, or 0 */ \
    X(media)              /* float4 by rank: index of refraction, and absorption per unit of length */ \
    X(energy)             /* float, see energy.h */                  \
    X(triangle_lights)    /* TriangleLight */                        \
    X(punctual_lights)    /* PunctualLight */                        \
    X(light_tree)         /* LightNode */                            \
    X(light_leaves)       /* LightLeaf */                            \
    X(light_trails)       /* LightTrail */                           \
    X(light_lists)        /* uint */                                 \
    X(hot_spots)          /* HotSpot */                              \
    X(lamps)              /* uint */                                 \
    X(light_grid)         /* LightGrid */                            \
    X(environment_texels) /* float */                                \
    X(environment_cdf)    /* float */                                \
    X(listed_pixels)      /* uint, 2 per entry of the current round of adaptive sampling */ \
    X(guide)              /* uint, CLARAY_GUIDE_WORDS for each map of the path guide */
// clang-format on

#endif
