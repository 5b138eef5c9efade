// Puts lists of hits or of primitives in order, with every triangle once. List i is from offsets[i] to offsets[i + 1] - 1.
#include "claray/shared/types.h"
#include "compute/portable.clh"

static inline bool before_hit(const Hit* a, const Hit* b) {
    return a->t < b->t || (a->t == b->t && a->primitive < b->primitive);
}
static inline bool before_id(const uint* a, const uint* b) { return *a < *b; }

/// Defines, for elements of a TYPE: sort_list_NAME, which sorts a list (heap sort: Williams 1964), removes repeated elements and
/// returns the number of the rest.
#define DEFINE_SORT(NAME, TYPE, BEFORE)                                                      \
    static inline void sink_##NAME(global TYPE* heap, uint at, uint size) {                  \
        const TYPE moved = heap[at];                                                         \
        for (uint child; (child = 2 * at + 1) < size; at = child) {                          \
            TYPE larger = heap[child];                                                       \
            if (child + 1 < size) {                                                          \
                const TYPE other = heap[child + 1];                                          \
                if (BEFORE(&larger, &other)) larger = other, ++child;                        \
            }                                                                                \
            if (!BEFORE(&moved, &larger)) break;                                             \
            heap[at] = larger;                                                               \
        }                                                                                    \
        heap[at] = moved;                                                                    \
    }                                                                                        \
    static inline uint sort_list_##NAME(global TYPE* list, uint size) {                      \
        for (uint at = size / 2; at-- > 0;) sink_##NAME(list, at, size);                     \
        for (uint end = size; end-- > 1;) {                                                  \
            const TYPE largest = list[0];                                                    \
            list[0] = list[end], list[end] = largest;                                        \
            sink_##NAME(list, 0, end);                                                       \
        }                                                                                    \
        uint kept = 0;                                                                       \
        for (uint at = 0; at < size; ++at) {                                                 \
            const TYPE element = list[at];                                                   \
            if (kept != 0) {                                                                 \
                const TYPE last = list[kept - 1];                                            \
                if (!BEFORE(&last, &element)) continue;                                      \
            }                                                                                \
            list[kept++] = element;                                                          \
        }                                                                                    \
        return kept;                                                                         \
    }

DEFINE_SORT(hit, Hit, before_hit)
DEFINE_SORT(id, uint, before_id)

/// Sort each list, remove repeated elements and write the number of the rest to counts[i].
kernel void sort_hits(global Hit* elements, global const uint* offsets, uint count, global uint* counts) {
    const uint i = get_global_id(0);
    if (i < count) counts[i] = sort_list_hit(elements + offsets[i], offsets[i + 1] - offsets[i]);
}
kernel void sort_ids(global uint* elements, global const uint* offsets, uint count, global uint* counts) {
    const uint i = get_global_id(0);
    if (i < count) counts[i] = sort_list_id(elements + offsets[i], offsets[i + 1] - offsets[i]);
}

/// Copy the lists to where they follow each other.
kernel void pack_hits(global const Hit* from, global const uint* from_offsets, uint count, global const uint* offsets, global Hit* to) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    for (uint at = offsets[i]; at < offsets[i + 1]; ++at) to[at] = from[from_offsets[i] + at - offsets[i]];
}
kernel void pack_ids(global const uint* from, global const uint* from_offsets, uint count, global const uint* offsets, global uint* to) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    for (uint at = offsets[i]; at < offsets[i + 1]; ++at) to[at] = from[from_offsets[i] + at - offsets[i]];
}
