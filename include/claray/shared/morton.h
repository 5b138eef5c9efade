// Morton codes: the bits of x, y and z interleaved, x highest.
#ifndef CLARAY_SHARED_MORTON_H
#define CLARAY_SHARED_MORTON_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// Inserts two zero bits between any two of the lowest 10 bits (Karras 2012).
CLARAY_SHARED_FUNCTION uint morton_spread10(uint v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
}

/// Inserts two zero bits between any two of the lowest 21 bits.
CLARAY_SHARED_FUNCTION ulong morton_spread21(uint value) {
    ulong v = value;
    v = (v | (v << 32)) & 0x001f00000000fffful;
    v = (v | (v << 16)) & 0x001f0000ff0000fful;
    v = (v | (v << 8)) & 0x100f00f00f00f00ful;
    v = (v | (v << 4)) & 0x10c30c30c30c30c3ul;
    return (v | (v << 2)) & 0x1249249249249249ul;
}

CLARAY_SHARED_FUNCTION uint morton30(uint x, uint y, uint z) {
    return (morton_spread10(x) << 2) | (morton_spread10(y) << 1) | morton_spread10(z);
    /// A code of 30 bits, from coordinates of 10 bits each.
}

CLARAY_SHARED_FUNCTION ulong morton63(uint x, uint y, uint z) {
    return (morton_spread21(x) << 2) | (morton_spread21(y) << 1) | morton_spread21(z);
    /// A code of 63 bits, from coordinates of 21 bits each.
}

CLARAY_SHARED_END

#endif
