// The look-back of Onesweep, over states that tiles may have while others wait.
#include "sort/radix_sort.cl"

/// One item a tile and digit.
kernel void look_back_at(uint tiles, volatile global uint* states, global uint* sums) {
    const uint i = get_global_id(0);
    if (i < tiles * DIGITS) sums[i] = look_back(states, i / DIGITS, i % DIGITS);
}
