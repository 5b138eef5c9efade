// The stage at the end of a bounce, one work-item: counts the rays and empties the queues that were worked off.
#include "claray/shared/portable.h"

/// `totals`: bounce rays, shadow rays.
kernel void advance_queues(global uint* worked_off, global const uint* next, global uint* shadow, global ulong* totals) {
    totals[0] += *next;
    totals[1] += *shadow;
    *worked_off = 0;
    *shadow = 0;
}
