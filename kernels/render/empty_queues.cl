// The stage at the end of a batch, one work-item: counts the rays of queues that are still to be counted, and empties them.
#include "claray/shared/portable.h"

/// `totals`: rays, the camera's among them, and shadow rays.
kernel void empty_queues(global uint* rays0, global uint* rays1, global uint* rays2, global uint* shadows0,
                         global uint* shadows1, global ulong* totals) {
    totals[0] += *rays0 + *rays1 + *rays2;
    totals[1] += *shadows0 + *shadows1;
    *rays0 = *rays1 = *rays2 = *shadows0 = *shadows1 = 0;
}
