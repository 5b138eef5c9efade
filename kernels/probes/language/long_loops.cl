// Loops of more than 65,535 iterations, one alone and two of fewer after another.
kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    uint bad = 0;
    if (i % 64 == 0) {  // the others are idle
        const uint most = 70000 + words[i] % 4096;
        uint count = 0, first = 0, second = 0;
        for (uint k = 0; k < most; ++k) count += words[k & 7] != 5;
        for (uint k = 0; k < 40000; ++k) first += words[k & 15] != 5;
        for (uint k = 0; k < 40000; ++k) second += words[k & 31] != 5;
        bad = (count != most) + (first != 40000) + (second != 40000);
    }
    wrong[i] = bad;
}
