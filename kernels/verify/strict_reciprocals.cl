// The division of builders, which all devices round alike.
#include "bvh/sbvh/references.clh"

/// Three per number: alone, in a lane of four, in a lane of sixteen.
kernel void strict_reciprocals_of(uint count, global const float* x, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    out[3 * i] = strict_reciprocal(x[i]);
    out[3 * i + 1] = strict_reciprocals((float4)(1.0f, 2.0f, x[i], 3.0f)).z;
    out[3 * i + 2] = strict_reciprocals16((float16)(x[i])).s9;
}
