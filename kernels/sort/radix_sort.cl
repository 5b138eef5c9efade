// Stable least-significant-digit radix sort of keys with 32-bit values for GPUs: Onesweep (Adinets and Merrill 2022).
// Histograms of all digits in one read, then a single kernel a digit that ranks its tile and learns its offset by decoupled
// look-back (Merrill and Garland 2016). Tiles are numbered by tickets, so that a tile only ever waits for tiles that already
// run: no forward-progress guarantee is needed. CPUs sort by bucket_sort.cl, to the same order: a stable sort has only one.
#include "compute/portable.clh"

#ifndef KEY_BITS
#define KEY_BITS 64  // of the key's type: 32 or 64
#endif
#ifndef GROUP_SIZE
#define GROUP_SIZE 256  // one work-item a digit: must be 256
#endif
#ifndef ITEMS
#define ITEMS 15  // keys a work-item
#endif

#if KEY_BITS == 64
typedef ulong Key;
#else
typedef uint Key;
#endif

#define DIGITS 256
#define PASSES (KEY_BITS / 8)
#define WARPS (GROUP_SIZE / 32)
#define TILE (GROUP_SIZE * ITEMS)

static inline uint digit_of(Key key, uint shift) { return (uint)(key >> shift) & (DIGITS - 1); }

/// Adds the histograms of all digits of all keys to `histogram`: PASSES x DIGITS counters, zero before.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void count_all_digits(global const Key* keys, uint count, global uint* histogram) {
    local uint counters[PASSES * DIGITS];
    const uint item = get_local_id(0);
    for (uint i = item; i < PASSES * DIGITS; i += GROUP_SIZE) counters[i] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = get_global_id(0); i < count; i += get_global_size(0)) {
        const Key key = keys[i];
        for (uint pass = 0; pass < PASSES; ++pass) atomic_inc(&counters[pass * DIGITS + digit_of(key, 8 * pass)]);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < PASSES * DIGITS; i += GROUP_SIZE)
        if (counters[i] != 0) atomic_add(&histogram[i], counters[i]);
}

/// Exclusive prefix sum of one value an item over the group; `scratch` holds GROUP_SIZE words (Hillis and Steele 1986).
static inline uint group_exclusive_sum(uint value, local uint* scratch) {
    const uint item = get_local_id(0);
    scratch[item] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint step = 1; step < GROUP_SIZE; step *= 2) {
        const uint before = item >= step ? scratch[item - step] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        scratch[item] += before;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    const uint sum = scratch[item] - value;
    barrier(CLK_LOCAL_MEM_FENCE);
    return sum;
}

/// Turns each digit position's histogram into the offsets where its digits begin: one group a pass.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void scan_histogram(global uint* histogram) {
    local uint scratch[GROUP_SIZE];
    const uint i = get_global_id(0);
    histogram[i] = group_exclusive_sum(histogram[i], scratch);
}

// A look-back word: 2 bits of state above 30 bits of count.
#define STATE_TILE 0x40000000u       // the count of this tile alone
#define STATE_INCLUSIVE 0x80000000u  // the count of this tile and all before it
#define STATE_COUNT 0x3fffffffu

/// Keys of `digit` in all tiles before `tile`.
static inline uint look_back(volatile global uint* states, uint tile, uint digit) {
    uint sum = 0;
    for (uint before = tile; before-- > 0;) {
        uint state;
        do {
            state = load_coherent(&states[before * DIGITS + digit]);
        } while (state == 0);
        sum += state & STATE_COUNT;
        if (state & STATE_INCLUSIVE) break;
    }
    return sum;
}

/// Sorts by the digit at `shift`. Behind `histogram` follow, zero before the first pass, a ticket for each pass, then the
/// look-back words, tiles x DIGITS for each pass. Without `values_in` the values are the keys' positions.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void sort_digit(global const Key* keys_in, global const uint* values_in, global Key* keys_out, global uint* values_out,
                uint count, uint shift, uint pass, volatile global uint* histogram, uint tiles) {
    volatile global uint* tickets = histogram + PASSES * DIGITS;
    local Key staged[TILE];  // the tile in sorted order; its values afterwards
    local uint warp_counts[WARPS][DIGITS];
    local uint target[DIGITS];
    local uint scratch[GROUP_SIZE];
#if !CLARAY_USE_PTX
    local uint match_scratch[WARPS][DIGITS];
#define MATCH_SCRATCH match_scratch[warp]
#else
#define MATCH_SCRATCH 0
#endif
    local uint shared_tile;

    const uint item = get_local_id(0), warp = item / WARP, lane = item % WARP;
    volatile global uint* states = tickets + PASSES + (size_t)pass * tiles * DIGITS;
    if (item == 0) shared_tile = atomic_inc(&tickets[pass]);
    for (uint w = 0; w < WARPS; ++w) {
        warp_counts[w][item] = 0;
#if !CLARAY_USE_PTX
        match_scratch[w][item] = 0;
#endif
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint tile = shared_tile, first = tile * TILE, in_tile = min((uint)TILE, count - first);

    // A warp's keys are consecutive, so that rank order is input order. Padding sorts behind everything.
    Key keys[ITEMS];
    uint ranks[ITEMS];
    const uint base = warp * (WARP * ITEMS) + lane;
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = base + i * WARP;
        keys[i] = at < in_tile ? keys_in[first + at] : ~(Key)0;
    }
    for (uint i = 0; i < ITEMS; ++i) {
        const uint digit = digit_of(keys[i], shift);
        const uint peers = warp_match(digit, MATCH_SCRATCH);
        const uint before = popcount(peers & ((1u << lane) - 1));
        ranks[i] = warp_counts[warp][digit] + before;
        warp_barrier();
        if (before == 0) warp_counts[warp][digit] += popcount(peers);
        warp_barrier();
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    // From here on item i owns digit i.
    uint total = 0;
    for (uint w = 0; w < WARPS; ++w) {
        const uint in_warp = warp_counts[w][item];
        warp_counts[w][item] = total;
        total += in_warp;
    }
    atomic_xchg(&states[tile * DIGITS + item], (tile == 0 ? STATE_INCLUSIVE : STATE_TILE) | total);
    const uint begin = group_exclusive_sum(total, scratch);  // of the digit within the tile
    for (uint w = 0; w < WARPS; ++w) warp_counts[w][item] += begin;
    if (tile != 0) {
        const uint previous = look_back(states, tile, item);
        atomic_xchg(&states[tile * DIGITS + item], STATE_INCLUSIVE | (previous + total));
        target[item] = histogram[pass * DIGITS + item] + previous - begin;
    } else {
        target[item] = histogram[pass * DIGITS + item] - begin;
    }
    barrier(CLK_LOCAL_MEM_FENCE);

    for (uint i = 0; i < ITEMS; ++i) {
        ranks[i] += warp_counts[warp][digit_of(keys[i], shift)];
        staged[ranks[i]] = keys[i];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    uint targets[ITEMS];
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = item + i * GROUP_SIZE;
        const Key key = staged[at];
        targets[i] = target[digit_of(key, shift)] + at;
        if (at < in_tile) keys_out[targets[i]] = key;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    local uint* staged_values = (local uint*)staged;
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = base + i * WARP;
        if (at < in_tile) staged_values[ranks[i]] = values_in ? values_in[first + at] : first + at;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = 0; i < ITEMS; ++i) {
        const uint at = item + i * GROUP_SIZE;
        if (at < in_tile) values_out[targets[i]] = staged_values[at];
    }
}
