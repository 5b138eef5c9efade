// The functions of rng.h, for the types CLARAY_WORD and CLARAY_PAIR, with names CLARAY_OF_WORD(name). Kernels for CPUs
// include this file a second time, for vectors of words.

/// A bijection of 32-bit words: all output bits depend on all input bits (constants: Wellons 2018, "lowbias32").
CLARAY_SHARED_FUNCTION CLARAY_WORD CLARAY_OF_WORD(hash_word)(CLARAY_WORD x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

CLARAY_SHARED_FUNCTION CLARAY_WORD CLARAY_OF_WORD(hash_words)(CLARAY_WORD a, CLARAY_WORD b) {
    return CLARAY_OF_WORD(hash_word)(a ^ (CLARAY_OF_WORD(hash_word)(b + 0x9e3779b9u) * 0x85ebca6bu));
}

CLARAY_SHARED_FUNCTION CLARAY_WORD CLARAY_OF_WORD(reverse_bits)(CLARAY_WORD x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/// Owen scrambling of a bit-reversed number: a hash of the lower bits decides whether a bit is flipped. The constants
/// are from Vegdahl (2021, "Building a better LK hash").
CLARAY_SHARED_FUNCTION CLARAY_WORD CLARAY_OF_WORD(owen_scramble_reversed)(CLARAY_WORD x, CLARAY_WORD seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

/// Bit-reversed second dimension of the Sobol sequence. Its generator matrix is Pascal's triangle modulo 2, the fifth
/// Kronecker power of (1 1; 0 1). Therefore these five steps replace a loop over 32 direction numbers.
CLARAY_SHARED_FUNCTION CLARAY_WORD CLARAY_OF_WORD(sobol_second_reversed)(CLARAY_WORD index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    return index ^ (index >> 16);
}

/// 1 if an odd number of bits is set.
CLARAY_SHARED_FUNCTION CLARAY_WORD CLARAY_OF_WORD(parity_of)(CLARAY_WORD x) {
    x ^= x >> 16;
    x ^= x >> 8;
    x ^= x >> 4;
    x ^= x >> 2;
    return (x ^ (x >> 1)) & 1u;
}

/// Point `index` of a shuffled and scrambled Sobol sequence. Different seeds give independent sequences. Two numbers
/// that differ in their lowest bit are neighbours in the sequence. The even
/// numbers get the points whose third Sobol coordinate is below 1/2, and the odd ones the others, or the reverse.
/// The coordinate is of the polynomial x^2 + x + 1. Its first bit is the parity of the bits 0, 1, 3, 4, 6, 7, and so
/// on. Three Sobol coordinates are a (1,3)-sequence, so that both halves are stratified as well: the first 2^m points
/// of a half have at most t = 1. A half cannot have t = 0 for every m, as the whole has: in base 2 there is no third
/// coordinate for that (Niederreiter 1987).
CLARAY_SHARED_FUNCTION CLARAY_PAIR CLARAY_OF_WORD(sobol_pair)(CLARAY_WORD index, CLARAY_WORD seed) {
    CLARAY_PAIR pair;
    const CLARAY_WORD neighbours = CLARAY_OF_WORD(reverse_bits)(CLARAY_OF_WORD(owen_scramble_reversed)(
                                       CLARAY_OF_WORD(reverse_bits)(index >> 1), seed))
                                   << 1;
    index = neighbours | ((CLARAY_OF_WORD(parity_of)(neighbours & 0xdb6db6dbu) ^ index) & 1u);  // mutant: sobol-halves
    pair.x = CLARAY_OF_WORD(reverse_bits)(
        CLARAY_OF_WORD(owen_scramble_reversed)(index, CLARAY_OF_WORD(hash_word)(seed ^ 0x68bc21ebu)));
    pair.y = CLARAY_OF_WORD(reverse_bits)(CLARAY_OF_WORD(owen_scramble_reversed)(
        CLARAY_OF_WORD(sobol_second_reversed)(index), CLARAY_OF_WORD(hash_word)(seed ^ 0x02e5be93u)));
    return pair;
}

/// Independent numbers from a counter: hashes of it, keyed by the seed, and of each other. A cheaper generator, pcg2d
/// (Jarzynski and Olano 2020), is not enough: three numbers of two dimensions filled a cube unevenly.
CLARAY_SHARED_FUNCTION CLARAY_PAIR CLARAY_OF_WORD(independent_pair)(CLARAY_WORD index, CLARAY_WORD seed) {
    CLARAY_PAIR pair;
    pair.x = CLARAY_OF_WORD(hash_word)(CLARAY_OF_WORD(hash_word)(index) ^ seed);  // mutant: independent-numbers
    pair.y = CLARAY_OF_WORD(hash_word)(pair.x ^ CLARAY_OF_WORD(hash_word)(seed ^ 0x68bc21ebu));
    return pair;
}
/// Returns the pair of numbers that sample `sample` of a pixel uses for `dimension`. The samples of even and of odd
/// number are the halves of sobol_pair in every dimension: the difference of their means estimates the error
/// (docs/accuracy.md).
CLARAY_SHARED_FUNCTION CLARAY_PAIR CLARAY_OF_WORD(sample_pair)(uint sampler, CLARAY_WORD pixel_seed, CLARAY_WORD sample,
                                                               CLARAY_WORD dimension) {
    const CLARAY_WORD seed =
        CLARAY_OF_WORD(hash_words)(sampler == CLARAY_SOBOL ? pixel_seed : pixel_seed ^ (sample & 1u), dimension);
    return sampler == CLARAY_SOBOL ? CLARAY_OF_WORD(sobol_pair)(sample, seed)
                                   : CLARAY_OF_WORD(independent_pair)(sample, seed);
}
