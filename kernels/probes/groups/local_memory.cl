// A group of 64 uses all local memory that the device has.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong, local uint* all, uint count) {
    const uint i = get_global_id(0), k = get_local_id(0), group = get_group_id(0);
    for (uint j = k; j < count; j += 64) all[j] = words[j & 16383] + j + group;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint bad = 0;
    for (uint j = 63 - k; j < count; j += 64) bad += all[j] != words[j & 16383] + j + group;  // what another item wrote
    wrong[i] = bad;
}
