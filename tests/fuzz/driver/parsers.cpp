// The parsers of scenes once more, from their headers, instrumented as the rest: the system's libraries are not, and
// would hide their branches from the fuzzer and their errors from the sanitizers.
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>
