// tinygltf as in parsers.cpp has no way to read and write images, and refers to one. claray decodes images itself.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace tinygltf {

bool LoadImageData(Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return false;
}

bool WriteImageData(const std::string*, const std::string*, const Image*, bool, std::string*, void*) { return false; }

}  // namespace tinygltf
