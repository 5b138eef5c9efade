// A header that clCompileProgram is given by name, and not a file of this name.
#include "claray_probe_header.h"

kernel void probe(global const uint* words, global uint* wrong) {
    const uint i = get_global_id(0);
    wrong[i] = words[i] + ANSWER - 42 != words[i];
}
