// Barriers in loops whose number of rounds depends on data, and is the same for all items of a group.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong) {
    local uint values[64];
    const uint i = get_global_id(0), k = get_local_id(0), group = i - k, rounds = words[group] % 13;
    values[k] = words[i];
    uint bad = 0;
    for (uint round = 0; round < rounds; ++round) {  // the values move by one place
        barrier(CLK_LOCAL_MEM_FENCE);
        const uint next = values[(k + 1) % 64];
        barrier(CLK_LOCAL_MEM_FENCE);
        values[k] = next;
        if ((words[group + round] & 3) == 0) continue;
        barrier(CLK_LOCAL_MEM_FENCE);
        bad += values[63 - k] != words[group + (63 - k + round + 1) % 64];
    }
    wrong[i] = bad + (values[k] != words[group + (k + rounds) % 64]);
}
