// Minima and maxima of floats by atomics on order-preserving integers, as for the builder's bounds.
#include "compute/portable.clh"

/// `keys`: 0xffffffff and 0 before.
kernel void float_atomics(uint count, global const uint* words, volatile global uint* keys, global uint* back) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const uint key = float_key(as_float(words[i]));
    atomic_min(&keys[0], key);
    atomic_max(&keys[1], key);
    back[i] = as_uint(float_from_key(key));
}
