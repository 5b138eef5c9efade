// Groups of any size: ids, and values that items of a group exchange.
kernel void probe(global const uint* words, global uint* wrong) {
    local uint count, sum;
    const uint i = get_global_id(0), k = get_local_id(0), size = get_local_size(0), group = get_group_id(0);
    if (k == 0) count = 0, sum = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    atomic_inc(&count), atomic_add(&sum, words[k & 16383]);
    barrier(CLK_LOCAL_MEM_FENCE);
    uint expected = 0;
    for (uint j = 0; j < size; ++j) expected += words[j & 16383];
    uint bad = count != size || sum != expected || get_num_groups(0) != 2 || get_global_size(0) != 2 * size;
    bad += i != group * size + k || k >= size || group >= 2 || get_work_dim() != 1 || get_local_size(1) != 1;
    wrong[i] = bad;
}
