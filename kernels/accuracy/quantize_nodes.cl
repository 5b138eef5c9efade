// Nodes of the binary tree with their boxes in few bits, rounded outward.
#include "accuracy/quantize_nodes.clh"

/// The least exponent with which LAST_STEP steps from `low` reach `high`.
static inline uint exponent_for(float low, float high) {
    const uint guess = (as_uint((high - low) * (1.0f / (float)LAST_STEP)) >> 23) & 0xffu;
    uint exponent = max(guess, 2u) - 1u;
    while (exponent < 254u && plane_at(low, exponent, LAST_STEP) < high) ++exponent;
    return exponent;
}

static inline uint step_below(float plane, float origin, uint exponent) {
    uint step = (uint)clamp((plane - origin) / as_float(exponent << 23) + 1.0f, 0.0f, (float)LAST_STEP);
    while (step > 0u && plane_at(origin, exponent, step) > plane) --step;  // mutant: study-quantized-lower
    return step;
}

static inline uint step_above(float plane, float origin, uint exponent) {
    uint step = (uint)clamp((plane - origin) / as_float(exponent << 23) - 1.0f, 0.0f, (float)LAST_STEP);
    while (step < LAST_STEP && plane_at(origin, exponent, step) < plane) ++step;  // mutant: study-quantized-upper
    return step;
}

static inline void store_step(uint* words, uint i, uint step) {
    words[i / STEPS_A_WORD] |= step << (i % STEPS_A_WORD * NODE_BITS);
}

kernel void quantize_nodes(global const BvhNode* nodes, uint count, global uint* quantized) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const BvhNode n = nodes[i];
    global uint* to = quantized + (size_t)i * NODE_WORDS;
    // Of each axis: lower and upper planes of the first child, then of the second.
    const float planes[12] = {n.lo0x, n.hi0x, n.lo1x, n.hi1x, n.lo0y, n.hi0y, n.lo1y, n.hi1y, n.lo0z, n.hi0z, n.lo1z, n.hi1z};
    uint words[12 / STEPS_A_WORD] = {0}, exponents = 0;
    for (uint axis = 0; axis < 3; ++axis) {
        const uint first = 4 * axis;
        const float low = fmin(planes[first], planes[first + 2]), high = fmax(planes[first + 1], planes[first + 3]);
        const uint exponent = exponent_for(low, high);
        to[axis] = as_uint(low);
        exponents |= exponent << (8 * axis);
        for (uint k = 0; k < 4; k += 2) {
            store_step(words, first + k, step_below(planes[first + k], low, exponent));
            store_step(words, first + k + 1, step_above(planes[first + k + 1], low, exponent));
        }
    }
    to[3] = exponents;
    for (uint w = 0; w < 12 / STEPS_A_WORD; ++w) to[4 + w] = words[w];
    to[NODE_WORDS - 2] = n.child0, to[NODE_WORDS - 1] = n.child1;
}
