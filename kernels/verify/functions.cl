// The functions of kernels/math/functions.clh, and divisions and square roots, on which they rely, of numbers and of vectors.
#include "bvh/sbvh/references.clh"
#include "math/vector.clh"

#define FUNCTIONS 12u

/// `pairs`: two numbers an item. `out`: FUNCTIONS values an item.
kernel void evaluate_functions(uint count, global const float* pairs, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float x = pairs[2 * i], y = pairs[2 * i + 1];
    global float* to = out + FUNCTIONS * i;
    to[0] = x / y;
    to[1] = sqrt(fabs(x));
    to[2] = exponential(x);
    to[3] = exponential_minus_1(x);
    to[4] = logarithm(fabs(x));
    to[5] = logarithm_2(fmax(fabs(x), 1.17549435e-38f));
    to[6] = logarithm_of_1_plus(x);
    to[7] = half_turns_of(y, x);
    to[8] = angle_of_cosine(fmin(fabs(x), 1.0f));
    const float2 around = cosine_and_sine(fabs(x) - floor(fabs(x)));
    to[9] = around.x, to[10] = around.y;
    to[11] = reciprocal_root(fabs(x));
}

/// Quotients and roots of sixteen numbers an item.
kernel void evaluate_vectors(uint count, global const float* x, global const float* y, global float* quotients, global float* roots) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float16 a = vload16(i, x), b = vload16(i, y);
    vstore16(a / b, i, quotients);
    vstore16(sqrt(fabs(a)), i, roots);
}

/// The division of builders. Three per number: alone, in a lane of four, in a lane of sixteen.
kernel void strict_reciprocals_of(uint count, global const float* x, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    out[3 * i] = strict_reciprocal(x[i]);
    out[3 * i + 1] = strict_reciprocals((float4)(1.0f, 2.0f, x[i], 3.0f)).z;
    out[3 * i + 2] = strict_reciprocals16((float16)(x[i])).s9;
}
