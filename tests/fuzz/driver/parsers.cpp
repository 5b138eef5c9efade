// tinyobjloader once more, from its header, instrumented as the rest: the system's library is not, and would hide its
// branches from the fuzzer and its errors from the sanitizers.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
