// Every item writes and reads its word of a buffer of more than 4 GB.
kernel void probe(global const uint* words, global uint* wrong, global uint* large) {
    const uint i = get_global_id(0);
    global uint* mine = large + (size_t)i * 17500000;  // 70,000,000 bytes
    *mine = words[i];
    barrier(CLK_GLOBAL_MEM_FENCE);
    uint bad = 0;
    for (uint k = 0; k < 64; ++k) bad += large[(ulong)k * 17500000] != words[k];
    barrier(CLK_GLOBAL_MEM_FENCE);
    *mine = i;
    wrong[i] = bad;
}
