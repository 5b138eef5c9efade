// Conversions that saturate and round at the limits of their types (OpenCL C 1.2, 6.2.3), compared with those by integers alone.
enum { to_zero, to_even, up, down };

long halved(long size, int shift, bool negative, int mode) {  // size / 2^shift, rounded
    if (shift <= 0) return size << min(-shift, 38);
    shift = min(shift, 40);
    const long whole = size >> shift, rest = size & ((1L << shift) - 1), middle = 1L << (shift - 1);
    if (mode == to_even) return whole + (rest > middle || (rest == middle && (whole & 1)));
    return whole + (rest != 0 && ((mode == up && !negative) || (mode == down && negative)));
}

long integer_of(float x, int mode) {
    const uint bits = as_uint(x), exponent = bits >> 23 & 255;
    const bool negative = bits >> 31;
    const long size = halved((bits & 0x7fffff) | (exponent > 0 ? 0x800000 : 0), 150 - (int)max(exponent, 1u), negative, mode);
    return negative ? -size : size;
}

long float_of(int x, int mode) {  // as the integer that this float is
    const long size = x < 0 ? -(long)x : x;
    const int shift = max(0, 40 - (int)clz(size));
    return (x < 0 ? -1 : 1) * (halved(size, shift, x < 0, mode) << shift);
}

uint wrong_integers(float x) {
    uint wrong = convert_int_sat(x) != clamp(integer_of(x, to_zero), (long)INT_MIN, (long)INT_MAX);
    wrong += convert_int_sat_rte(x) != clamp(integer_of(x, to_even), (long)INT_MIN, (long)INT_MAX);
    wrong += convert_uint_sat_rtp(x) != clamp(integer_of(x, up), 0L, (long)UINT_MAX);
    wrong += convert_short_sat_rtn(x) != clamp(integer_of(x, down), (long)SHRT_MIN, (long)SHRT_MAX);
    wrong += convert_uchar_sat_rte(x) != clamp(integer_of(x, to_even), 0L, 255L);
    wrong += convert_char_sat_rtp(x) != clamp(integer_of(x, up), -128L, 127L);
    return wrong;
}

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), word = words[i], exponent = 120 + word % 41;  // 2^-7 to 2^33
    const float x = as_float((words[i + 16384] & 0x807fffff) | exponent << 23), near = (float)(int)(word >> 20) + 0.5f;
    const int integer = (int)word >> (words[i + 32768] & 31);
    uint bad = wrong_integers(x) + wrong_integers(near - 2048) + wrong_integers((float)integer);
    bad += (long)convert_float_rtz(integer) != float_of(integer, to_zero);
    bad += (long)convert_float_rte(integer) != float_of(integer, to_even);
    bad += (long)convert_float_rtp(integer) != float_of(integer, up);
    bad += (long)convert_float_rtn(integer) != float_of(integer, down);
    bad += convert_uchar_sat(integer) != clamp(integer, 0, 255) || convert_short_sat(integer) != clamp(integer, -32768, 32767);
    bad += convert_int_sat((uint)word) != (int)min(word, (uint)INT_MAX) || convert_uint_sat(integer) != (uint)max(integer, 0);
    wrong[i] = bad;
}
