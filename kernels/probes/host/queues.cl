// Commands of four queues in turns, each of which waits for the one before: step k finds what step k - 1 wrote, by another item.
kernel void probe(global const uint* words, global uint* wrong, uint step) {
    global uint* mine = wrong + (get_global_id(0) + 64 * step) % get_global_size(0);
    const bool right = step == 0 || *mine == step;
    if (step < 64) *mine = right ? step + 1 : 1000;
    if (step == 64) *mine = !right;
}
