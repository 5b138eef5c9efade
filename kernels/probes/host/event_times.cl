// Work whose duration the events of the host measure.
kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    uint x = words[i];
    for (uint k = 0; k < 1000; ++k) x = x * 1664525 + words[k & 15];
    wrong[i] = x;
}
