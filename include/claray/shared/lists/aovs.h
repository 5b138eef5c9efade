// The list of all AOVs. The members of `Aovs`, the kernel's outputs, the names of `--aov`, the layers of an EXR, the
// pictures and the arrays of Python are made from it (kernels/render/write_aovs.cl, docs/architecture.md).
#ifndef CLARAY_SHARED_LISTS_AOVS_H
#define CLARAY_SHARED_LISTS_AOVS_H

// A row is X(name, kind, "letters", "meaning"):
//   name     Aovs::name, and the function aov_name in kernels/render/write_aovs.cl
//   kind     the type of a pixel, and how a picture shows it: distance, share (float), direction, color, place (three
//            floats), coordinates, movement (two floats), identifier or count (uint)
//   letters  the channels of the layer of an EXR
// clang-format off
#define CLARAY_AOVS(X)                                                                                     \
    X(depth, distance, "Z", "distance from the camera, +inf if nothing is hit")                            \
    X(normal, direction, "XYZ", "shading normal, on the camera's side")                                    \
    X(albedo, color, "RGB", "albedo, plus emitted light up to 1")                                          \
    X(primitive, identifier, "X", "number of the primitive, CLARAY_MISS if none")                          \
    X(material, identifier, "X", "number of the material, CLARAY_MISS if none")                            \
    X(heat, count, "X", "number of boxes and triangles tested")                                            \
    X(object, identifier, "X", "number of the mesh or, after all meshes, of the set of primitives")        \
    X(instance, identifier, "X", "number of the instance, CLARAY_MISS if none")                            \
    X(position, place, "XYZ", "point of the surface in the world, 0 0 0 if nothing is hit")                \
    X(uv, coordinates, "UV", "first texture coordinates of the mesh, 0 0 if there are none")               \
    X(roughness, share, "Y", "roughness, 0 of mirrors and 1 of diffuse surfaces, 0 if nothing is hit")     \
    X(emission, color, "RGB", "radiance that the surface emits")                                           \
    X(motion, movement, "XY", "pixels right and down that the point moves while the shutter is open")
// clang-format on

#endif
