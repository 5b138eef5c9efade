// + - * and fma neither flush subnormal arguments nor subnormal results, and round them to the nearest. Subnormal floats are multiples
// of 2^-149, which their bits count.
uint rounded(uint x, uint shift) {  // x / 2^shift, to the nearest, half to even
    const uint whole = x >> shift, rest = x & ((1u << shift) - 1), middle = 1u << (shift - 1);
    return whole + (rest > middle || (rest == middle && (whole & 1)));
}

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    const uint a = words[i] >> 21, b = words[i + 16384] >> 21, c = words[i + 32768] >> 10, shift = 1 + words[i + 49152] % 12;
    const float x = ldexp((float)a, -70), y = ldexp((float)b, -79 - (int)shift);  // their product is a b 2^-shift 2^-149
    const float small = as_float(c), smaller = as_float(a);
    uint bad = as_uint(small + smaller) != c + a;
    bad += as_uint(small - smaller) != (c >= a ? c - a : (a - c) | 0x80000000);
    bad += as_uint(x * y) != rounded(a * b, shift);
    bad += as_uint(small * 0.5f) != rounded(c, 1);
    bad += as_uint(fma(x, y, 0.f)) != rounded(a * b, shift);
    bad += as_uint(fma(small, 1.f, smaller)) != c + a;
    const float exact = ldexp((float)b, -79);  // no rounding
    bad += as_uint(fma(x, exact, small)) != a * b + c;
    wrong[i] = bad;
}
