// Every item adds 1 to a counter that all groups share, 64 times, and takes part in a minimum, a maximum and an exchange of its own group.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong, volatile global uint* counters) {
    local uint least, most, taken, stack;
    const uint i = get_global_id(0), k = get_local_id(0), group = i - k;
    if (k == 0) least = UINT_MAX, most = 0, taken = 0, stack = 64;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint bad = 0;
    for (uint j = 0; j < 64; ++j) bad += atomic_inc(counters) >= 16384 * 64;
    atomic_min(&least, words[i]), atomic_max(&most, words[i]);
    for (uint before = taken, seen; (seen = atomic_cmpxchg(&taken, before, before + k + 1)) != before;) before = seen;
    atomic_xchg(&stack, k);
    barrier(CLK_LOCAL_MEM_FENCE);
    bad += taken != 64 * 65 / 2 || stack >= 64;
    bool is_least = false, is_most = false;
    for (uint j = 0; j < 64; ++j) {
        const uint word = words[group + j];
        bad += word < least || word > most;
        is_least |= word == least, is_most |= word == most;
    }
    wrong[i] = bad + !is_least + !is_most;
}
