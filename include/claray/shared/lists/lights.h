// The list of the kinds of lights that are no triangles and no images. The kinds, effects, names and checks on the
// host, and in the kernels the choice among kinds are made from it (kernels/lights/kinds.clh, docs/architecture.md).
#ifndef CLARAY_SHARED_LISTS_LIGHTS_H
#define CLARAY_SHARED_LISTS_LIGHTS_H

// PunctualLight::kind. Macros, since kernels read them.
#define CLARAY_POINT_LIGHT 0u
#define CLARAY_DIRECTIONAL_LIGHT 1u
#define CLARAY_SPOT_LIGHT 2u
#define CLARAY_SUN_LIGHT 3u

// A row is X(name, NAME, "name for users", far, cone):
//   name  LightKind::name, Effect::name_lights, kernels/lights/name.clh with view_name_light
//   NAME  its number is CLARAY_NAME_LIGHT; kernels have its code under the macro NAME_LIGHTS
//   far   1: it shines on the whole scene from one direction, and its intensity is an irradiance; 0: from a position
//   cone  1: it has a direction, and shines within Light::outer_angle of it

/// Lights without extent, which only shadow rays find.
#define CLARAY_HIDDEN_LIGHTS(X)                      \
    X(point, POINT, "point", 0, 0)                   \
    X(directional, DIRECTIONAL, "directional", 1, 0) \
    X(spot, SPOT, "spot", 0, 1)

/// Far lights with an extent: rays that leave the scene find them, too. kernels/lights/name.clh has
/// radiance_of_name_light.
#define CLARAY_SEEN_LIGHTS(X) X(sun, SUN, "sun", 1, 1)

#define CLARAY_LIGHT_KINDS(X) CLARAY_HIDDEN_LIGHTS(X) CLARAY_SEEN_LIGHTS(X)

#endif
