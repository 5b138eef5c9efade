// Stable least-significant-digit radix sort of keys with 32-bit values for GPUs: Onesweep (Adinets and Merrill 2022).
// One read makes the histograms of all digits. Then one kernel per digit ranks a tile and finds its offset by decoupled look-back
// (Merrill and Garland 2016). Tiles are numbered by tickets, so that a tile waits only for tiles that already run; no guarantee of
// forward progress is needed. CPUs use bucket_sort.cl, with the same result, because a stable sort has only one.
#include "compute/group_sum.clh"
#include "compute/portable.clh"

#ifndef KEY_BITS
#define KEY_BITS 64  // of the key type: 32 or 64
#endif
#ifndef ITEMS
#define ITEMS 13  // keys per work-item
#endif

#if KEY_BITS == 64
#define Key ulong
#else
#define Key uint
#endif

#define DIGITS 256
#define PASSES (KEY_BITS / 8)
#define WARPS (DIGITS / 32)
#define TILE (DIGITS * ITEMS)
#define MASKS_AS_KEYS (WARPS * DIGITS * 4 / (KEY_BITS / 8))
#define STAGED (TILE > MASKS_AS_KEYS ? TILE : MASKS_AS_KEYS)

static inline uint digit_of(Key key, uint shift) { return (uint)(key >> shift) & (DIGITS - 1); }

/// Adds the histograms of all digits of all keys to `histogram`: PASSES x DIGITS counters, zero before.
kernel __attribute__((reqd_work_group_size(DIGITS, 1, 1)))
void count_all_digits(global const Key* keys, uint count, global uint* histogram) {
    local uint counters[PASSES * DIGITS];
    const uint item = get_local_id(0);
    for (uint i = item; i < PASSES * DIGITS; i += DIGITS) counters[i] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        const Key key = keys[i];
        for (uint pass = 0; pass < PASSES; ++pass) atomic_inc(&counters[pass * DIGITS + digit_of(key, 8 * pass)]);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < PASSES * DIGITS; i += DIGITS)
        if (counters[i] != 0) atomic_add(&histogram[i], counters[i]);
}

/// Turns the histogram of each pass into the offsets of its digits: one group per pass.
kernel __attribute__((reqd_work_group_size(DIGITS, 1, 1)))
void scan_histogram(global uint* histogram) {
    local uint scratch[DIGITS];
    const uint i = get_global_id(0);
    uint total;
    histogram[i] = group_exclusive_sum(histogram[i], scratch, &total);
}

// A look-back word: 2 bits of state above 30 bits of count.
#define STATE_TILE 0x40000000u       // the count of this tile alone
#define STATE_INCLUSIVE 0x80000000u  // the count of this tile and all before it
#define STATE_COUNT 0x3fffffffu

/// The state of the tile `back` tiles before `tile`: zero if it is not known yet.
static inline uint state_before(volatile global uint* states, uint tile, uint back, uint digit) {
    return back <= tile ? load_coherent(&states[(tile - back) * DIGITS + digit]) : 0;
}

/// Number of keys of `digit` in all tiles before `tile`. Four states are loaded at once to hide the latency of memory. They are
/// added up to the first that is unknown or that includes all tiles before it.
static inline uint look_back(volatile global uint* states, uint tile, uint digit) {
    uint sum = 0;
    while (tile > 0) {
        const uint a = state_before(states, tile, 1, digit), b = state_before(states, tile, 2, digit),
                   c = state_before(states, tile, 3, digit), d = state_before(states, tile, 4, digit);
        const bool ends_a = (a & STATE_INCLUSIVE) != 0, takes_b = a != 0 && !ends_a && b != 0,
                   ends_b = takes_b && (b & STATE_INCLUSIVE), takes_c = takes_b && !ends_b && c != 0,
                   ends_c = takes_c && (c & STATE_INCLUSIVE), takes_d = takes_c && !ends_c && d != 0,
                   ends_d = takes_d && (d & STATE_INCLUSIVE);
        sum += (a & STATE_COUNT) + (takes_b ? b & STATE_COUNT : 0) + (takes_c ? c & STATE_COUNT : 0) +
               (takes_d ? d & STATE_COUNT : 0);
        if (ends_a || ends_b || ends_c || ends_d) break;
        tile -= (a != 0) + takes_b + takes_c + takes_d;
    }
    return sum;
}

/// For each key, the number of earlier keys of its digit. `next` holds the counts before this warp's keys, and afterwards those
/// before the next warp's. `masks` is zero before and after; each item sets its bit there for others with its digit.
static inline void rank_keys(const Key* keys, uint shift, local uint* next, local uint* masks, uint* ranks) {
    const uint lane = (uint)get_local_id(0) % WARP;
    for (uint i = 0; i < ITEMS; ++i) {
        const uint digit = digit_of(keys[i], shift);
        atomic_or(&masks[digit], 1u << lane);
        warp_barrier();
        const uint peers = masks[digit], before = popcount(peers & ((1u << lane) - 1));
        ranks[i] = next[digit] + before;
        warp_barrier();
        if (before == 0) next[digit] += popcount(peers), masks[digit] = 0;
        warp_barrier();
    }
}

/// Sorts by the digit at `shift`. After `histogram` follow one ticket per pass, then the look-back words, tiles x DIGITS per pass,
/// all zero before the first pass. Without `values_in` the values are the keys' positions.
kernel __attribute__((reqd_work_group_size(DIGITS, 1, 1)))
void sort_digit(global const Key* keys_in, global const uint* values_in, global Key* keys_out, global uint* values_out,
                uint count, uint shift, uint pass, volatile global uint* histogram, uint tiles) {
    volatile global uint* tickets = histogram + PASSES * DIGITS;
    local Key staged[STAGED];  // first the masks of the warps, then the tile in sorted order, then its values
    local uint warp_counts[WARPS][DIGITS];
    local uint target[DIGITS];
    local uint scratch[DIGITS];
    local uint shared_tile;

    const uint item = get_local_id(0), warp = item / WARP, lane = item % WARP;
    volatile global uint* states = tickets + PASSES + (size_t)pass * tiles * DIGITS;
    local uint* masks = (local uint*)staged;
    if (item == 0) shared_tile = atomic_inc(&tickets[pass]);
    for (uint w = 0; w < WARPS; ++w) warp_counts[w][item] = masks[w * DIGITS + item] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint tile = shared_tile, first = tile * TILE, in_tile = min((uint)TILE, count - first);

    // A warp's keys are consecutive, so that ranks follow the input order. Padding is sorted to the end.
    Key keys[ITEMS];
    uint values[ITEMS], ranks[ITEMS];
    const uint base = warp * (WARP * ITEMS) + lane;
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = base + i * WARP;
        keys[i] = at < in_tile ? keys_in[first + at] : ~(Key)0;
    }
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = base + i * WARP;
        values[i] = values_in && at < in_tile ? values_in[first + at] : first + at;
    }

    // The tile's counts are published first, because other tiles wait for them. Item i handles digit i here.
    for (uint i = 0; i < ITEMS; ++i) atomic_inc(&warp_counts[warp][digit_of(keys[i], shift)]);
    barrier(CLK_LOCAL_MEM_FENCE);
    uint total = 0, all;
    for (uint w = 0; w < WARPS; ++w) total += warp_counts[w][item];
    atomic_xchg(&states[tile * DIGITS + item], (tile == 0 ? STATE_INCLUSIVE : STATE_TILE) | total);
    const uint begin = group_exclusive_sum(total, scratch, &all);  // of the digit within the tile
    uint next = begin;
    for (uint w = 0; w < WARPS; ++w) {
        const uint in_warp = warp_counts[w][item];
        warp_counts[w][item] = next;
        next += in_warp;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    rank_keys(keys, shift, warp_counts[warp], &masks[warp * DIGITS], ranks);
    barrier(CLK_LOCAL_MEM_FENCE);

    for (uint i = 0; i < ITEMS; ++i) staged[ranks[i]] = keys[i];
    const uint previous = look_back(states, tile, item);
    if (tile != 0) atomic_xchg(&states[tile * DIGITS + item], STATE_INCLUSIVE | (previous + total));
    target[item] = histogram[pass * DIGITS + item] + previous - begin;
    barrier(CLK_LOCAL_MEM_FENCE);

    uint targets[ITEMS];
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = item + i * DIGITS;
        const Key key = staged[at];
        targets[i] = target[digit_of(key, shift)] + at;
        if (at < in_tile) keys_out[targets[i]] = key;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    local uint* staged_values = (local uint*)staged;
    for (uint i = 0; i < ITEMS; ++i) staged_values[ranks[i]] = values[i];
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = item + i * DIGITS;
        if (at < in_tile) values_out[targets[i]] = staged_values[at];
    }
}
