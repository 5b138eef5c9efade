// The list of what surrounds a scene's surfaces. The members of Sky and SkyData, their checks, copies and digests are
// made from it.
#ifndef CLARAY_SHARED_LISTS_SKY_H
#define CLARAY_SHARED_LISTS_SKY_H

// A row is COLOR(name, "name in errors") or NUMBER(name, "name in errors"): three floats or one, finite and not
// negative, 0 by default.
//   horizon, zenith  radiance of rays that leave the scene, linear in the sine of their elevation; below the horizon
//                    that of the horizon
//   fog              between the surfaces, but not in glass. Over a distance d, exp(-fog_density d) of the light is
//                    left, and the rest becomes fog_color. Before what is infinitely far (horizon, zenith,
//                    environment, far lights) lies fog of the length fog_depth.
#define CLARAY_SKY(COLOR, NUMBER)             \
    COLOR(horizon, "radiance of the horizon") \
    COLOR(zenith, "radiance of the zenith")   \
    COLOR(fog_color, "colour of the fog")     \
    NUMBER(fog_density, "density of the fog") \
    NUMBER(fog_depth, "depth of the fog")

#endif
