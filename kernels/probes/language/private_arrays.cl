// A private array that a loop writes and reads by indices that only the data tell.
kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    uint places[16], found[16];
    for (uint k = 0; k < 16; ++k) places[k] = k, found[k] = 0;
    for (uint k = 15; k > 0; --k) {  // a permutation
        const uint other = words[i + k] % (k + 1), place = places[k];
        places[k] = places[other], places[other] = place;
    }
    for (uint k = 0; k < 16; ++k) found[places[k]] += k + 1;
    uint sum = 0, bad = 0;
    for (uint k = 0; k < 16; ++k) bad += found[k] == 0 || places[(found[k] - 1) & 15] != k, sum += found[k];
    bad += sum != 136;
    uchar bytes[61];  // a stack whose top moves by the data
    uint top = 0, pushed = 0, popped = 0, left = 0;
    for (uint k = 0; k < 60; ++k) {
        const uint word = words[i + 16 * k];
        if ((word & 3) != 0 || top == 0)
            bytes[top++] = (uchar)(word >> 8), pushed += word >> 8 & 255;
        else
            popped += bytes[--top];
    }
    for (uint k = 0; k < top; ++k) left += bytes[k];
    wrong[i] = bad + (pushed != popped + left);
}
