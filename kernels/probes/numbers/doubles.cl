// float64 + - * / sqrt and fma round to the nearest: compared with integers. Differences are known modulo 2^64, and are far below that.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

ulong mantissa(double x) { return (as_ulong(x) & 0xfffffffffffff) | 0x10000000000000; }
int exponent(double x) { return (int)(as_ulong(x) >> 52 & 2047) - 1075; }  // |x| is mantissa(x) 2^exponent(x)
ulong low_bits(double x) { return exponent(x) < 0 ? mantissa(x) >> -exponent(x) : exponent(x) > 63 ? 0 : mantissa(x) << exponent(x); }

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    const ulong a = ((ulong)words[i] << 20 ^ words[i + 16384]) | 1UL << 51 | 1, b = ((ulong)words[i + 32768] << 20 ^ words[i + 49152]) | 1UL << 51;
    const double x = (double)a, y = (double)b, product = x * y, ratio = x / y, root = sqrt(x);
    // products have up to 104 bits: the error is at most half a unit in the last place, 2^(exponent - 1)
    const long error = (long)(a * b - low_bits(product));
    uint bad = abs(error) > 1UL << (exponent(product) - 1);
    bad += fma(x, y, -product) != (double)error;
    bad += fma(x, y, 1.0) != product && abs(error) < 1UL << (exponent(product) - 2);  // 1 changes nothing
    // a = ratio b + rest with |rest| <= b / 2 units of the ratio, whose exponent is -52 or -53
    const long rest = (long)((a << -exponent(ratio)) - mantissa(ratio) * b);
    bad += abs(rest) > b / 2;
    // (2 r - 1)^2 <= 4 a <= (2 r + 1)^2: r^2 differs from a by at most r, in units of the root squared
    const long beside = (long)((a << -2 * exponent(root)) - mantissa(root) * mantissa(root));
    bad += abs(beside) > mantissa(root);
    bad += x + y != (double)(a + b) || x - y != (double)((long)a - (long)b) || (ulong)x != a || floor(ratio) != (double)(a / b);
    const double small = x * 0x1p-1074;  // a subnormal, whose bits count units of 2^-1074
    bad += as_ulong(small) != a || as_ulong(small * 0.5) != (a >> 1) + (a >> 1 & 1) || as_ulong(fma(small, 0.5, 0.0)) != (a >> 1) + (a >> 1 & 1);
    wrong[i] = bad;
}
