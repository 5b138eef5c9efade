// The container of a binary glTF, and what holds for the JSON of both kinds.
#pragma once

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

/// The parts of a glTF's bytes.
struct GltfContainer {
    std::string_view json;
    std::optional<std::string_view> binary;  ///< the data of a .glb, if it holds any
};

/// Parts of a .gltf or .glb. Chunks of other kinds, and what follows the length that a .glb states, are left out.
/// Throws where a chunk is cut off, the version is not 2, or the JSON is nested too deeply for a parser by recursion.
[[nodiscard]] GltfContainer open_container(std::string_view bytes, const GltfFile& file);

}  // namespace claray
