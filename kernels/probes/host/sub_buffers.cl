// A part of a buffer, as an argument, begins where the host says, and shares its memory with the buffer.
kernel void probe(global uint* words, global uint* wrong, global uint* part, uint first) {
    const uint i = get_global_id(0), before = words[first + i];
    uint bad = part[i] != before;
    part[i] = before + 1;
    bad += ((volatile global uint*)words)[first + i] != before + 1;
    wrong[i] = bad;
}
