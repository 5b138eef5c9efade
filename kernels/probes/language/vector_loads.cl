// vloadn and vstoren at addresses that no vector is aligned to, in global, local and private memory.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0), k = get_local_id(0);
    local uint shared[64 * 17 + 1];
    uint own[37];
    for (uint j = 0; j < 37; ++j) own[j] = words[i + j] ^ 5;
    const uint2 two = vload2(k, words + i);
    const uint3 three = vload3(k, words + i + 1);
    const uint4 four = vload4(k, words + i + 3);
    const uint8 eight = vload8(k, words + i + 2);
    const uint16 sixteen = vload16(k, words + i + 1), of_own = vload16(1, own + 1 + k % 4);
    uint bad = two.x != words[i + 2 * k] || two.y != words[i + 2 * k + 1];
    bad += three.x != words[i + 1 + 3 * k] || three.y != words[i + 2 + 3 * k] || three.z != words[i + 3 + 3 * k];
    bad += four.x != words[i + 3 + 4 * k] || four.w != words[i + 6 + 4 * k] || eight.s0 != words[i + 2 + 8 * k] || eight.s7 != words[i + 9 + 8 * k];
    bad += sixteen.s0 != words[i + 1 + 16 * k] || sixteen.s9 != words[i + 10 + 16 * k] || sixteen.sf != words[i + 16 + 16 * k];
    bad += of_own.s0 != own[17 + k % 4] || of_own.s7 != own[24 + k % 4] || of_own.sf != own[32 + k % 4];
    shared[17 * k] = k;
    vstore16(sixteen, 0, shared + 17 * k + 1);  // at every remainder of 16
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint next = (k + 1) % 64, j = i - k + next;
    bad += shared[17 * next] != next || shared[17 * next + 1] != words[j + 1 + 16 * next] || shared[17 * next + 16] != words[j + 16 + 16 * next];
    barrier(CLK_LOCAL_MEM_FENCE);
    vstore3(three, k, shared + 1);
    barrier(CLK_LOCAL_MEM_FENCE);
    bad += shared[3 * next + 1] != words[j + 1 + 3 * next] || shared[3 * next + 3] != words[j + 3 + 3 * next];
    const uchar3 bytes = vload3(k, (global const uchar*)words + i + 1);  // at odd addresses
    const uint at = i + 1 + 3 * k;
    bad += bytes.x != (words[at / 4] >> at % 4 * 8 & 255) || bytes.z != (words[(at + 2) / 4] >> (at + 2) % 4 * 8 & 255);
    wrong[i] = bad;
}
