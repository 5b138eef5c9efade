// 64-bit integers, compared with pairs of 32 bits.
ulong product_above(ulong x, ulong y) {  // the upper 64 bits of 128
    const ulong x0 = x & 0xffffffff, x1 = x >> 32, y0 = y & 0xffffffff, y1 = y >> 32;
    const ulong middle = x1 * y0 + (x0 * y0 >> 32), other = x0 * y1 + (middle & 0xffffffff);
    return x1 * y1 + (middle >> 32) + (other >> 32);
}

ulong quotient(ulong x, ulong y) {  // bit by bit
    ulong result = 0, rest = 0;
    for (int bit = 63; bit >= 0; --bit) {
        const bool carry = rest >> 63;
        rest = rest << 1 | (x >> bit & 1);
        if (carry || rest >= y) rest -= y, result |= 1UL << bit;
    }
    return result;
}

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), low = words[i], high = words[i + 16384], n = words[i + 32768], by = n & 63;
    const ulong x = (ulong)high << 32 | low, y = ((ulong)n << 32 | high) >> (words[i + 49152] & 63) | 1;
    const uint2 shifted = by >= 32 ? (uint2)(0, low << (by - 32)) : by == 0 ? (uint2)(low, high) : (uint2)(low << by, high << by | low >> (32 - by));
    uint bad = x << by != as_ulong(shifted) || as_uint2(x).x != low || as_uint2(x).y != high;
    bad += x * y != as_ulong((uint2)((uint)x * (uint)y, mul_hi((uint)x, (uint)y) + (uint)x * (uint)(y >> 32) + high * (uint)y));
    bad += mul_hi(x, y) != product_above(x, y);
    bad += x / y != quotient(x, y) || x % y != x - quotient(x, y) * y;
    bad += clz(y) != ((y >> 32) ? clz((uint)(y >> 32)) : 32 + clz((uint)y)) || popcount(x) != popcount(low) + popcount(high);
    bad += rotate(x, (ulong)by) != (by ? x << by | x >> (64 - by) : x);
    bad += add_sat(x, y) != (x > ~y ? ULONG_MAX : x + y) || sub_sat(x, y) != (x < y ? 0 : x - y);
    const long a = (long)x, b = (long)(y << 1);
    bad += add_sat(a, b) != (a > 0 && b > LONG_MAX - a ? LONG_MAX : a < 0 && b < LONG_MIN - a ? LONG_MIN : a + b);
    bad += convert_int_sat(a) != (int)clamp(a, (long)INT_MIN, (long)INT_MAX) || convert_uint_sat(x) != (uint)min(x, (ulong)UINT_MAX);
    bad += (a >> by) != (by ? (long)(x >> by) | -(long)(x >> 63) << (64 - by) : a);
    wrong[i] = bad;
}
