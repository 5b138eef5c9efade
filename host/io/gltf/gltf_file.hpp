// A glTF file as tinygltf reads it, checked where tinygltf trusts. No image is read or decoded yet.
#pragma once

#include "host/io/gltf/decode/tinygltf.hpp"

#include "claray/io.hpp"

namespace claray {

/// A channel of an animation that moves what its JSON pointer names (KHR_animation_pointer), and no node.
struct GltfPointer {
    std::size_t animation = 0;
    int sampler = -1;
    std::string place;
};

/// New numbers of a place in the JSON.
struct GltfChange {
    std::string place;
    std::vector<double> numbers;
};

struct GltfFile {
    std::filesystem::path path;
    std::string json;  ///< as tinygltf took it
    tinygltf::Model model;
    std::vector<GltfPointer> pointers;
    std::size_t channels_left_out = 0;  ///< of animations: they move nothing that is known

    /// Reads nodes, materials, cameras and lights again, with these numbers in the JSON. Returns how many changes have
    /// a place that the file lacks or that cannot move.
    std::size_t change(const std::vector<GltfChange>& changes);

    /// Throws ErrorKind::user: "'path': what; remedy".
    [[noreturn]] void fail(const std::string& what, const std::string& remedy = "export it again") const;

    /// The bytes of a buffer view. Throws where it is none or leaves its buffer; `what` names who wants it.
    [[nodiscard]] std::string_view view(int index, const std::string& what) const;
};

/// Reads a .gltf or .glb and the buffers it names. Unknown extensions: an error where required, a warning where used.
[[nodiscard]] GltfFile read_gltf(const std::filesystem::path& path, Warnings& warnings);
/// The same of bytes. What they name is in the folder of `path`, which messages name.
[[nodiscard]] GltfFile read_gltf(const std::filesystem::path& path, std::string_view bytes, Warnings& warnings);

/// "kind 'name'", or "kind INDEX" where it has none.
[[nodiscard]] std::string gltf_name(const char* kind, const std::string& name, std::size_t index);

}  // namespace claray
