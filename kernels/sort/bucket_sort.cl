// Stable sort of keys with 32-bit values for CPUs. One pass moves the keys into buckets by their highest bits, in few runs of
// consecutive keys; then each bucket is sorted in the cache. There a key and its position in the bucket share one word. All words
// differ, so that values need not be moved and the passes need not be stable.
#include "compute/portable.clh"

#ifndef KEY_BITS
#define KEY_BITS 64  // of the key type: 32 or 64
#endif
#ifndef BUCKET_BITS
#define BUCKET_BITS 13
#endif

#if KEY_BITS == 64
#define Key ulong
#else
#define Key uint
#endif

#define BUCKETS (1u << BUCKET_BITS)

/// The highest BUCKET_BITS of the `bits` lowest, or all of them.
static inline uint bucket_of(Key key, uint bits) {
    const uint shift = bits > BUCKET_BITS ? bits - BUCKET_BITS : 0, bucket_bits = min(bits, (uint)BUCKET_BITS);
    return (uint)(key >> shift) & ((1u << bucket_bits) - 1);
}

static inline uint run_begin(uint run, uint runs, uint count) { return (uint)((ulong)count * run / runs); }

/// Each item counts one run of keys: counts[bucket * runs + run].
kernel void count_buckets(global const Key* keys, uint count, uint bits, uint runs, global uint* counts) {
    const uint run = get_global_id(0);
    if (run >= runs) return;
    uint counters[BUCKETS];
    for (uint bucket = 0; bucket < BUCKETS; ++bucket) counters[bucket] = 0;
    const uint end = run_begin(run + 1, runs, count);
    for (uint i = run_begin(run, runs, count); i < end; ++i) ++counters[bucket_of(keys[i], bits)];
    for (uint bucket = 0; bucket < BUCKETS; ++bucket) counts[bucket * runs + run] = counters[bucket];
}

/// Exclusive prefix sum of all counts, by a single item.
kernel void scan_buckets(uint runs, global uint* counts) {
    if (get_global_id(0) != 0) return;
    uint sum = 0;
    for (uint i = 0; i < BUCKETS * runs; ++i) {
        const uint value = counts[i];
        counts[i] = sum;
        sum += value;
    }
}

/// Each item moves the keys of one run into their buckets, with their original positions.
kernel void fill_buckets(global const Key* keys, global Key* keys_out, global uint* values_out, uint count, uint bits,
                         uint runs, global const uint* counts) {
    const uint run = get_global_id(0);
    if (run >= runs) return;
    uint offsets[BUCKETS];
    for (uint bucket = 0; bucket < BUCKETS; ++bucket) offsets[bucket] = counts[bucket * runs + run];
    const uint end = run_begin(run + 1, runs, count);
    for (uint i = run_begin(run, runs, count); i < end; ++i) {
        const Key key = keys[i];
        const uint to = offsets[bucket_of(key, bits)]++;
        keys_out[to] = key;
        values_out[to] = i;
    }
}

// ---- in the cache --------------------------------------------------------------------------------------------------

#define SLOT_BITS (BUCKET_BITS < 12u ? BUCKET_BITS : 12u)  // the keys of a bucket agree in BUCKET_BITS, which frees these bits
#define SMALL (1u << SLOT_BITS)                            // the largest bucket whose positions fit beside the keys' bits

static inline uint highest_bit(ulong word) { return 63u - (uint)clz(word); }

/// The bits in which the words differ.
static inline ulong varying_bits(const ulong* words, uint count) {
    ulong varying = 0;
    for (uint i = 1; i < count; ++i) varying |= words[i] ^ words[0];
    return varying;
}

#define MAX_DIGIT_BITS 8u

/// Stable sort by `digit_bits` bits from `shift` on.
static inline void sort_words_by_digit(const ulong* words, ulong* sorted, uint count, uint shift, uint digit_bits) {
    const uint digits = 1u << digit_bits, mask = digits - 1;
    uint offsets[1u << MAX_DIGIT_BITS];
    for (uint digit = 0; digit < digits; ++digit) offsets[digit] = 0;
    for (uint i = 0; i < count; ++i) ++offsets[(uint)(words[i] >> shift) & mask];
    uint sum = 0;
    for (uint digit = 0; digit < digits; ++digit) {
        const uint value = offsets[digit];
        offsets[digit] = sum;
        sum += value;
    }
    for (uint i = 0; i < count; ++i) sorted[offsets[(uint)(words[i] >> shift) & mask]++] = words[i];
}

/// Sorts by 2 * digit_bits bits from `shift` on. A digit that would end beyond the word is moved down over bits sorted before.
static inline void sort_words_by_two_digits(ulong* words, ulong* other, uint count, uint shift, uint digit_bits) {
    const uint most = 64 - digit_bits;
    sort_words_by_digit(words, other, count, min(shift, most), digit_bits);
    sort_words_by_digit(other, words, count, min(shift + digit_bits, most), digit_bits);
}

static inline void insertion_sort(ulong* words, uint count) {
    for (uint i = 1; i < count; ++i) {
        const ulong word = words[i];
        uint at = i;
        for (; at > 0 && words[at - 1] > word; --at) words[at] = words[at - 1];
        words[at] = word;
    }
}

/// Returns whether so many consecutive words agree from `shift` on that insertion sort would be slow.
static inline bool has_long_run(const ulong* words, uint count, uint shift) {
    const uint most = 16;
    for (uint i = most; i < count; ++i)
        if (words[i] >> shift == words[i - most] >> shift) return true;
    return false;
}

/// Two passes over the highest bits that vary order nearly all words; otherwise all bits are sorted.
static inline void sort_words(ulong* words, ulong* other, uint count) {
    const uint few = 24;
    if (count > few) {
        const ulong varying = varying_bits(words, count) >> SLOT_BITS << SLOT_BITS;
        if (varying == 0) return;
        const uint end = highest_bit(varying) + 1, lowest = highest_bit(varying & -varying);
        const uint digit_bits = min(MAX_DIGIT_BITS, highest_bit(count));
        const uint shift = max(lowest, end > 2 * digit_bits ? end - 2 * digit_bits : 0);
        sort_words_by_two_digits(words, other, count, shift, digit_bits);
        if (shift == lowest) return;
        if (has_long_run(words, count, shift)) {
            for (uint at = lowest; at < end; at += 2 * MAX_DIGIT_BITS)
                sort_words_by_two_digits(words, other, count, at, MAX_DIGIT_BITS);
            return;
        }
    }
    insertion_sort(words, count);
}

/// Sorts keys begin .. end - 1 (at most SMALL) by their `bits` lowest bits (at most 64 - BUCKET_BITS).
static inline void sort_small(global const Key* keys, global const uint* values, global Key* keys_out,
                              global uint* values_out, uint begin, uint end, uint bits, ulong* words, ulong* other) {
    const uint count = end - begin;
    for (uint i = 0; i < count; ++i)
        words[i] = ((ulong)keys[begin + i] & ((1ul << bits) - 1)) << SLOT_BITS | i;
    sort_words(words, other, count);
    for (uint i = 0; i < count; ++i) {
        const uint from = begin + ((uint)words[i] & (SMALL - 1));
        keys_out[begin + i] = keys[from];
        values_out[begin + i] = values[from];
    }
}

/// Sorts keys begin .. end - 1, which differ only in their `bits` lowest bits, into smaller buckets by the highest eight bits in
/// which they differ. Bucket i is then at bounds[i] .. bounds[i + 1]. Returns false if all keys are equal.
static inline bool split_bucket(global Key* keys, global uint* values, global Key* keys_out, global uint* values_out,
                                uint begin, uint end, uint bits, uint* bounds) {
    const Key mask = (Key)((1ul << bits) - 1);
    Key varying = 0;
    for (uint i = begin; i < end; ++i) varying |= keys[i] ^ keys[begin];
    varying &= mask;
    const uint top = varying != 0 ? highest_bit(varying) + 1 : 0, shift = top > 8 ? top - 8 : 0;
    for (uint digit = 0; digit <= 256; ++digit) bounds[digit] = 0;
    for (uint i = begin; i < end; ++i) ++bounds[(uint)((keys[i] & mask) >> shift) & 255];
    uint sum = begin;
    for (uint digit = 0; digit <= 256; ++digit) {
        const uint value = bounds[digit];
        bounds[digit] = sum;
        sum += value;
    }
    for (uint i = begin; i < end; ++i) {
        const uint to = bounds[(uint)((keys[i] & mask) >> shift) & 255]++;
        keys_out[to] = keys[i];
        values_out[to] = values[i];
    }
    for (uint digit = 256; digit > 0; --digit) bounds[digit] = bounds[digit - 1];
    bounds[0] = begin;
    if (varying == 0) return false;
    for (uint i = begin; i < end; ++i) keys[i] = keys_out[i], values[i] = values_out[i];
    return true;
}

/// Each item sorts the buckets that begin in its share of the keys. A bucket too large for the cache is split first.
kernel void sort_buckets(global Key* keys, global uint* values, global Key* keys_out, global uint* values_out,
                         uint count, uint bits, uint runs, global const uint* counts) {
    ulong words[SMALL], other[SMALL];
    uint bounds[257];
    uint2 large[256 * (KEY_BITS / 8 + 1)];  // each split uses eight bits, or all that are left
    const uint share = get_global_id(0), shares = get_global_size(0);
    const uint share_begin = run_begin(share, shares, count), share_end = run_begin(share + 1, shares, count);
    const uint low_bits = bits > BUCKET_BITS ? bits - BUCKET_BITS : 0;
    uint bucket = 0;
    for (uint above = BUCKETS; bucket < above;) {  // the first bucket that begins in the share
        const uint middle = (bucket + above) / 2;
        if (counts[middle * runs] < share_begin) bucket = middle + 1;
        else above = middle;
    }
    for (; bucket < BUCKETS && counts[bucket * runs] < share_end; ++bucket) {
        const uint2 range = (uint2)(counts[bucket * runs], bucket + 1 < BUCKETS ? counts[(bucket + 1) * runs] : count);
        if (range.y - range.x <= SMALL) {
            sort_small(keys, values, keys_out, values_out, range.x, range.y, low_bits, words, other);
            continue;
        }
        uint depth = 0;
        large[depth++] = range;
        while (depth != 0) {
            const uint2 part = large[--depth];
            if (!split_bucket(keys, values, keys_out, values_out, part.x, part.y, low_bits, bounds)) continue;
            for (uint i = 0; i < 256; ++i) {
                const uint2 smaller = (uint2)(bounds[i], bounds[i + 1]);
                if (smaller.y - smaller.x > SMALL) large[depth++] = smaller;
                else sort_small(keys, values, keys_out, values_out, smaller.x, smaller.y, low_bits, words, other);
            }
        }
    }
}
