// A kernel that two threads compile and run at once, each in a context of its own.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong) {
    local uint values[64];
    const uint i = get_global_id(0), k = get_local_id(0);
    values[k] = words[i];
    barrier(CLK_LOCAL_MEM_FENCE);
    wrong[i] = values[63 - k] != words[i - k + 63 - k];
}
