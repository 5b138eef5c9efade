// The JSON of a glTF as tinygltf takes it.
#pragma once

#include <vector>

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

/// Where a buffer or an image of the file has its bytes.
struct GltfSource {
    std::string uri;
    int view = -1;             ///< of an image
    std::size_t length = 0;    ///< of a buffer, in bytes
    bool is_optional = false;  ///< the buffer only stands for what is compressed elsewhere
};

/// What tinygltf 2.7 is stricter with than the format, or reads before anyone knows that it is wanted, is taken out of
/// its sight: bytes of buffers and images; indices that have no bytes; and channels of animations that move no
/// node, as KHR_animation_pointer has them.
struct AdaptedJson {
    std::string text;
    std::vector<GltfSource> buffers, images;  ///< by index in the file
    std::vector<std::vector<int>> indices;    ///< of each mesh's primitives: those without a view, else -1
    std::vector<GltfPointer> pointers;
    std::size_t channels_left_out = 0;
};

/// Throws where the JSON is broken.
[[nodiscard]] AdaptedJson adapted_to_tinygltf(std::string_view json, const GltfFile& file);

/// Writes the numbers of the changes into such a text. Returns how many have no place there.
[[nodiscard]] std::size_t write_changes(std::string& text, const std::vector<GltfChange>& changes);

}  // namespace claray
