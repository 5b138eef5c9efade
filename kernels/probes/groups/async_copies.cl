// async_work_group_copy and async_work_group_strided_copy to local memory and back.
kernel __attribute__((reqd_work_group_size(64, 1, 1))) void probe(global const uint* words, global uint* wrong) {
    local uint near[100], strided[64], results[64];
    local float4 vectors[16];
    const uint i = get_global_id(0), k = get_local_id(0), group = i - k, by = 1 + words[group] % 9;
    event_t copied = async_work_group_copy(near, words + group + 3, 100, 0);
    copied = async_work_group_strided_copy(strided, words + group, 64, by, copied);
    event_t other = async_work_group_copy(vectors, (global const float4*)words + group / 4, 16, 0);
    wait_group_events(1, &copied);
    wait_group_events(1, &other);
    uint bad = near[k] != words[group + 3 + k] || near[99 - k] != words[group + 102 - k];
    bad += strided[63 - k] != words[group + (63 - k) * by];
    bad += as_uint(vectors[k / 4].w) != words[group + k / 4 * 4 + 3];
    results[63 - k] = bad;
    barrier(CLK_LOCAL_MEM_FENCE);
    event_t written = async_work_group_copy(wrong + group, results, 64, 0);
    wait_group_events(1, &written);
}
