// Atomics of 64 bits in local memory, by all items of a group.
#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable

kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong) {
    local ulong sum, other;
    const uint i = get_global_id(0), k = get_local_id(0), group = i - k;
    sum = 0xffffff00, other = 1;
    barrier(CLK_LOCAL_MEM_FENCE);
    const ulong before = atom_add(&sum, (ulong)words[i] << 8);
    for (ulong seen = other, last; (last = atom_cmpxchg(&other, seen, seen * 3)) != seen;) seen = last;
    barrier(CLK_LOCAL_MEM_FENCE);
    ulong expected = 0xffffff00, power = 1;
    for (uint j = 0; j < 64; ++j) expected += (ulong)words[group + j] << 8, power *= 3;
    wrong[i] = (sum != expected) + (other != power) + (before > expected);
}
