// The one translation unit that compiles tinygltf.
#define TINYGLTF_IMPLEMENTATION
#include "host/io/gltf/decode/tinygltf.hpp"
