// The G-buffer's packed formats: 12 bytes per pixel, as deferred renderers keep them. Kernels and the host convert
// alike.
#ifndef CLARAY_SHARED_GBUFFER_H
#define CLARAY_SHARED_GBUFFER_H

#include "claray/shared/angles.h"
#include "claray/shared/portable.h"

#ifndef __OPENCL_C_VERSION__
#include <cmath>
#endif

CLARAY_SHARED_BEGIN

#ifndef __OPENCL_C_VERSION__
using std::fabs;
using std::floor;
using std::fmax;
using std::fmin;
using std::sqrt;
#endif

/// The first surface at a pixel's centre.
typedef struct GBufferPixel {
    uint albedo_material;  // bytes from the lowest: red, green, blue as sRGB, and the material's index, at most 255
    uint normal;           // shading normal, two 16-bit numbers: octahedral or spherical
    float depth;  // reversed: 1 on the near plane, or at the camera if it is orthographic, 0 infinitely far away
} GBufferPixel;
CLARAY_LAYOUT(GBufferPixel, 12)

typedef struct UnitVector {
    float x, y, z;
} UnitVector;
CLARAY_LAYOUT(UnitVector, 12)

#define CLARAY_NO_SURFACE \
    0xffffffffu  // GBufferPixel::normal of a pixel without a surface; no unit vector has this code

CLARAY_SHARED_FUNCTION uint claray_unorm16(float value) {
    return (uint)floor(fmin(fmax(value, 0.0f), 1.0f) * 65534.0f + 0.5f);
}
CLARAY_SHARED_FUNCTION float claray_from_unorm16(uint code) { return (float)(code & 0xffffu) / 65534.0f; }

/// The octahedron's faces unfolded to a square (Meyer et al. 2010, "On floating-point normal vectors"; Cigolle et al.
/// 2014, "A survey of efficient representations for independent unit vectors").
CLARAY_SHARED_FUNCTION uint claray_pack_octahedral(UnitVector n) {
    const float scale = 1.0f / (fabs(n.x) + fabs(n.y) + fabs(n.z));
    float u = n.x * scale, v = n.y * scale;
    if (n.z < 0.0f) {
        const float folded = (1.0f - fabs(v)) * (u >= 0.0f ? 1.0f : -1.0f);
        v = (1.0f - fabs(u)) * (v >= 0.0f ? 1.0f : -1.0f);
        u = folded;
    }
    return claray_unorm16(0.5f * u + 0.5f) | claray_unorm16(0.5f * v + 0.5f) << 16;
}
CLARAY_SHARED_FUNCTION UnitVector claray_unpack_octahedral(uint code) {
    float u = 2.0f * claray_from_unorm16(code) - 1.0f, v = 2.0f * claray_from_unorm16(code >> 16) - 1.0f;
    const float z = 1.0f - fabs(u) - fabs(v), below = fmax(-z, 0.0f);
    u += u >= 0.0f ? -below : below;
    v += v >= 0.0f ? -below : below;  // mutant: octahedral-fold
    const float scale = 1.0f / sqrt(u * u + v * v + z * z);
    const UnitVector n = {u * scale, v * scale, z * scale};
    return n;
}

/// Azimuth and angle from the z axis, each in equal steps. The mean error is that of the octahedron, at the price of
/// transcendental functions.
CLARAY_SHARED_FUNCTION uint claray_pack_spherical(UnitVector n) {
    const float azimuth = 0.5f * (float)claray_half_turns(n.y, n.x) + 0.5f;
    const float polar = (float)claray_half_turns(sqrt(n.x * n.x + n.y * n.y), n.z);
    return claray_unorm16(azimuth) | claray_unorm16(polar) << 16;
}
CLARAY_SHARED_FUNCTION UnitVector claray_unpack_spherical(uint code) {
    const float azimuth = 2.0f * claray_from_unorm16(code) - 1.0f, polar = claray_from_unorm16(code >> 16);
    const float radius = (float)claray_sine(polar);
    const UnitVector n = {radius * (float)claray_cosine(azimuth), radius * (float)claray_sine(azimuth),
                          (float)claray_cosine(polar)};
    return n;
}

CLARAY_SHARED_END

#endif
