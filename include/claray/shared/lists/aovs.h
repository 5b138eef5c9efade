// The list of all AOVs. The members of `Aovs`, the kernel's outputs, the names of `--aov`, the layers of an EXR, the
// pictures and the arrays of Python are made from it (kernels/render/write_aovs.cl, docs/architecture.md).
#ifndef CLARAY_SHARED_LISTS_AOVS_H
#define CLARAY_SHARED_LISTS_AOVS_H

// A row is X(name, kind, "letters", "meaning"):
//   name     Aovs::name, and the function aov_name in kernels/render/write_aovs.cl
//   kind     the type of a pixel, and how a picture shows it: distance (float), direction or color (three floats),
//            identifier or count (uint)
//   letters  the channels of the layer of an EXR
#define CLARAY_AOVS(X)                                                            \
    X(depth, distance, "Z", "distance from the camera, +inf if nothing is hit")   \
    X(normal, direction, "XYZ", "shading normal, on the camera's side")           \
    X(albedo, color, "RGB", "albedo, plus emitted light up to 1")                 \
    X(primitive, identifier, "X", "number of the primitive, CLARAY_MISS if none") \
    X(material, identifier, "X", "number of the material, CLARAY_MISS if none")   \
    X(heat, count, "X", "number of boxes and triangles tested")

#endif
