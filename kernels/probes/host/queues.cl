// Commands of four queues in turns, each of which waits for the one before: a step finds what the one before wrote, by another item.
kernel void probe(global const uint* words, global uint* wrong, global uint* steps) {
    const uint i = get_global_id(0), step = steps[i]++;
    global uint* mine = wrong + (i + 64 * step) % get_global_size(0);
    const bool right = step == 0 || *mine == step;
    *mine = step == 64 ? !right : right ? step + 1 : 1000;
}
