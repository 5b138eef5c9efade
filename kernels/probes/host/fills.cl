// Nothing but a buffer, which the host fills.
kernel void probe(global const uint* words, global uint* wrong) { wrong[get_global_id(0)] = words[get_global_id(0)]; }
