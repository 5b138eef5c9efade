// tinygltf, compiled here and under a name of its own: the libdraco of Debian and Ubuntu exports another version of it,
// and of two the linker takes the first for both.
#pragma once

#define tinygltf claray_tinygltf
#define TINYGLTF_NO_STB_IMAGE  // images are claray's own business
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>
