// Functions of 32-bit integers, compared with loops over bits and with 64 bits.
uint ones(uint x) {
    uint count = 0;
    for (; x != 0; x >>= 1) count += x & 1;
    return count;
}

uint zeros_before(uint x) {
    uint count = 0;
    for (uint bit = 0x80000000; bit != 0 && !(x & bit); bit >>= 1) ++count;
    return count;
}

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), y = words[i + 16384], n = words[i + 32768], x = words[i] >> (n & 31), by = n >> 8 & 63;
    const int a = (int)words[i], b = (int)y;
    const long sum = (long)a + b, product = (long)a * b;
    uint bad = popcount(x) != ones(x) || popcount((uchar)x) != ones(x & 255);
    bad += clz(x) != zeros_before(x) || clz((ushort)x) != zeros_before(x & 0xffff) - 16 || clz((uchar)x) != zeros_before(x & 255) - 24;
    bad += mul_hi(x, y) != (uint)((ulong)x * y >> 32) || mul_hi(a, b) != (int)(product >> 32);
    bad += mad_hi(x, y, n) != (uint)((ulong)x * y >> 32) + n;
    bad += x << by != x << (by & 31) || x >> by != x >> (by & 31) || a >> by != (int)((long)a >> (by & 31));  // modulo the width: 6.3.j
    bad += (x << by) != (uint)((ulong)x << (by & 31));
    bad += rotate(x, by) != ((by & 31) ? x << (by & 31) | x >> (32 - (by & 31)) : x);
    bad += add_sat(a, b) != (int)clamp(sum, (long)INT_MIN, (long)INT_MAX) || add_sat(x, y) != (uint)min((ulong)x + y, (ulong)UINT_MAX);
    bad += sub_sat(a, b) != (int)clamp((long)a - b, (long)INT_MIN, (long)INT_MAX) || sub_sat(x, y) != (x > y ? x - y : 0);
    bad += mad_sat(a, b, a) != (int)clamp(product + a, (long)INT_MIN, (long)INT_MAX);
    bad += hadd(a, b) != (int)(sum >> 1) || rhadd(a, b) != (int)((sum + 1) >> 1) || hadd(x, y) != (uint)(((ulong)x + y) >> 1);
    bad += abs_diff(a, b) != (uint)(a > b ? (long)a - b : (long)b - a) || abs(a) != (uint)(a < 0 ? -(long)a : a);
    bad += mul24(a >> 8, b >> 8) != (int)((long)(a >> 8) * (b >> 8)) || upsample((ushort)x, (ushort)y) != (x << 16 | (y & 0xffff));
    if (b != 0 && !(a == INT_MIN && b == -1)) bad += a / b != (int)((long)a / b) || a % b != (int)((long)a % b);
    if (n % 1000 != 0) bad += y / (n % 1000) != (uint)((ulong)y / (n % 1000)) || y % (n % 1000) != y - y / (n % 1000) * (n % 1000);
    wrong[i] = bad;
}
