// The operations that decide hits and trees, compiled like geometry kernels: the host compares the results with its own.
#include "trace/numerics.clh"

#define OPERATIONS 6

/// For each triple of words: sum, difference, product, fused multiply-add, and a * b + c and a * b - c * c without contraction.
kernel void arithmetic32(uint count, global const uint* triples, global uint* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const float a = as_float(triples[3 * i]), b = as_float(triples[3 * i + 1]), c = as_float(triples[3 * i + 2]);
    const float results[OPERATIONS] = {a + b, a - b, a * b, fma(a, b, c), a * b + c, a * b - c * c};
    for (uint k = 0; k < OPERATIONS; ++k) out[OPERATIONS * i + k] = as_uint(results[k]);
}

#if CLARAY_FP64
/// The same in float64 for the words' values, and the quotient and the Kahan determinant a a - b c of numerics.clh.
kernel void arithmetic64(uint count, global const double* triples, global double* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const double a = triples[3 * i], b = triples[3 * i + 1], c = triples[3 * i + 2];
    const double results[OPERATIONS] = {a + b, a - b, a * b, fma(a, b, c), a / b, determinant(a, b, c, a)};
    for (uint k = 0; k < OPERATIONS; ++k) out[OPERATIONS * i + k] = results[k];
}
#else
kernel void arithmetic64(uint count, global const uint* triples, global uint* out) {}
#endif

/// Approximate operations, on whose accuracy error bounds rely.
kernel void approximations(uint count, global const float* x, global float* out) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    out[3 * i] = near_reciprocal((float3)(x[i])).x;
    out[3 * i + 1] = rough_reciprocal(x[i]);
    out[3 * i + 2] = near_sqrt(x[i]);
}
