// With -cl-fp32-correctly-rounded-divide-sqrt division and sqrt round to the nearest: compared with integers.
uint mantissa(float x) { return (as_uint(x) & 0x7fffff) | 0x800000; }
int exponent(float x) { return (int)(as_uint(x) >> 23 & 255) - 150; }  // |x| is mantissa(x) 2^exponent(x)

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), a = words[i] >> 8 | 0x800000, b = words[i + 16384] >> 8 | 0x800000;
    const float x = (float)a, y = (float)b, ratio = x / y, root = sqrt(x);
    // a = ratio b + rest with |rest| <= b / 2 units of the ratio
    const long rest = (long)((ulong)a << -exponent(ratio)) - (long)mantissa(ratio) * b;
    uint bad = abs(rest) > b / 2;
    // (2 r - 1)^2 <= 4 a <= (2 r + 1)^2, in units of the root squared: a differs from r^2 by at most r
    const long beside = (long)((ulong)a << -2 * exponent(root)) - (long)mantissa(root) * mantissa(root);
    bad += abs(beside) > mantissa(root);
    bad += as_uint(ldexp(x, 40) / ldexp(y, -40)) != as_uint(ldexp(ratio, 80));
    bad += x / x != 1 || sqrt(x * 0x1p-60f) != ldexp(root, -30);
    wrong[i] = bad;
}
