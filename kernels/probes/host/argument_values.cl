// Commands that wait in a queue keep the arguments that they were enqueued with: item k writes in the command of step k only.
kernel void probe(global const uint* words, global uint* wrong, uint step) {
    const uint i = get_global_id(0);
    if (i == step) wrong[i] = 1000 + step;
    if (step == 64) wrong[i] = wrong[i] != 1000 + i;
}
