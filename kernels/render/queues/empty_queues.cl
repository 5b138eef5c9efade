// The stage at the end of a batch, one work-item: counts the rays of queues that are not counted yet, and empties queues and lists.
#include "render/queue.clh"

/// `totals`: rays including camera rays, and shadow rays.
kernel void empty_queues(global QueueLength* lengths, global ulong* totals) {
    for (uint i = 0; i < CLARAY_RAY_QUEUES; ++i) totals[0] += lengths[i].length, lengths[i].length = 0;
    for (uint i = CLARAY_RAY_QUEUES; i < CLARAY_RAY_QUEUES + CLARAY_SHADOW_QUEUES; ++i)
        totals[1] += lengths[i].length, lengths[i].length = 0;
    for (uint i = CLARAY_RAY_QUEUES + CLARAY_SHADOW_QUEUES; i < CLARAY_QUEUE_LENGTHS; ++i) lengths[i].length = 0;
}
