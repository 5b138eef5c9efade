// With FP_CONTRACT OFF no product is added unrounded: a b - c is 0 if c is the rounded product.
#pragma OPENCL FP_CONTRACT OFF

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), a = words[i] >> 8 | 0x800000, b = words[i + 16384] >> 8 | 0x800000;
    const ulong product = (ulong)a * b;
    const uint shift = product >> 47 ? 24 : 23;
    const ulong whole = product >> shift, rest = product & ((1UL << shift) - 1), middle = 1UL << (shift - 1);
    const float x = (float)a, y = (float)b;
    const float rounded = ldexp((float)(uint)(whole + (rest > middle || (rest == middle && (whole & 1)))), (int)shift);
    uint bad = x * y - rounded != 0;
    bad += x * y + -rounded != 0 || rounded - x * y != 0;
    bad += x * y - y * x != 0;
    float sum = 0;
    for (uint k = 0; k < 4; ++k) sum += x * y - rounded;
    wrong[i] = bad + (sum != 0);
}
