// The picture for a display: exposure, tone map, sRGB and 8 bits.
#include "claray/shared/picture.h"
#include "math/vector.clh"

/// The curve of host/base/color.cpp with the same operations, which all devices round alike.
static inline float filmic(float x) {
    if (!(x > 0.0f)) return 0.0f;
    x = fmin(x, 1e6f);
    return fmin((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), 1.0f);
}

/// The largest byte whose step is not above x. The table of first bytes by the leading bits of x leaves few steps to try
/// (Giesen 2012, "Fast float to sRGB8", interpolates instead, which is not exact).
static inline uchar srgb_byte(float x, global const SrgbTable* table) {
    if (!(x > 0.0f)) return 0;
    x = fmin(x, 0.99999994f);
    const uint bits = as_uint(x) >> CLARAY_SRGB_SHIFT;
    uint byte = table->first[bits > CLARAY_SRGB_LEAST ? bits - CLARAY_SRGB_LEAST : 0];
    for (uint i = 0; i < CLARAY_SRGB_STEPS; ++i) byte += x >= table->step[byte + 1] ? 1u : 0u;
    return (uchar)byte;
}

/// `image`: three linear floats per pixel; `picture`: red, green, blue, 255.
kernel void tone_map(global const float* image, uint pixels, float gain, uint is_filmic, global const SrgbTable* table,
                     global uchar* picture) {
    const uint i = get_global_id(0);
    if (i >= pixels) return;
    float3 color = gain * load3(image, i);
    if (is_filmic) color = (float3)(filmic(color.x), filmic(color.y), filmic(color.z));
    vstore4((uchar4)(srgb_byte(color.x, table), srgb_byte(color.y, table), srgb_byte(color.z, table), 255), i, picture);
}
