// A loop with barriers ends when one item says so in local memory. Meanwhile each item counts the rounds by itself.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong) {
    local uint left;
    const uint i = get_global_id(0), k = get_local_id(0), rounds = 1 + words[i - k] % 20;
    uint turned = 0;
    left = rounds;
    barrier(CLK_LOCAL_MEM_FENCE);
    while (left > 0) {
        ++turned;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (k == turned % 64) --left;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    wrong[i] = turned != rounds;
}
