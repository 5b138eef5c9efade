// A kernel of sixteen arguments of all sizes.
kernel void probe(global const uint* words, global uint* wrong, global const uint* b, global uint* c, constant uint* d,
                  global const uint4* e, global const uchar* f, uchar n1, ushort n2, uint n4, ulong n8, char m1, short m2, int m4, long m8,
                  float4 four) {
    const uint i = get_global_id(0), word = words[i];
    uint bad = b[i] != word || d[i % 1024] != words[i % 1024] || e[i / 4].y != words[i / 4 * 4 + 1] || f[i] != (words[i / 4] >> i % 4 * 8 & 255);
    bad += c[i] != word;
    bad += n1 != 21 || n2 != 24 || n4 != 27 || n8 != 30;
    bad += m1 != 33 || m2 != 36 || m4 != 39 || m8 != 42;
    bad += four.x != 1.5f || four.y != 2.5f || four.z != 3.5f || four.w != 4.5f;
    wrong[i] = bad;
}
