// Compressed geometry of glTF: KHR_draco_mesh_compression, EXT_meshopt_compression and KHR_meshopt_compression, decoded
// by the libraries Draco and meshoptimizer where claray was built with them.
#pragma once

#include <algorithm>
#include <iterator>

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

inline constexpr const char* draco_extension = "KHR_draco_mesh_compression";
/// The second is the first with another version of the codec, and one filter more.
inline constexpr const char* meshopt_extensions[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

[[nodiscard]] inline bool is_meshopt(std::string_view extension) {
    return std::find(std::begin(meshopt_extensions), std::end(meshopt_extensions), extension) !=
           std::end(meshopt_extensions);
}

/// Whether this is one of the three.
[[nodiscard]] bool is_compression(std::string_view extension);
/// Whether claray was built with its library.
[[nodiscard]] bool can_decode(std::string_view extension);

/// Decodes all compressed data that can be decoded: accessors and views then refer to plain buffers. Throws if the
/// data is damaged or does not fit its description.
void decompress(GltfFile& file);

/// The parts that a library does; each appends to the model's buffers, views and accessors.
void decode_draco_primitive(GltfFile& file, tinygltf::Primitive& primitive, const std::string& name);
void decode_meshopt_view(GltfFile& file, tinygltf::BufferView& view, const char* extension, const std::string& name);

/// An integer of an extension; `fallback` where it is not given. Throws where it is negative or no integer.
[[nodiscard]] std::size_t count_in(const GltfFile& file, const tinygltf::Value& object, const char* key,
                                   std::size_t fallback, const std::string& name);

}  // namespace claray
