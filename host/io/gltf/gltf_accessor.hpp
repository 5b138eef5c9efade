// glTF accessors: typed views of buffers.
#pragma once

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

/// The elements of an accessor as floats; integers that are `normalized` become 0..1 or -1..1. Throws where the
/// accessor has another number of components or leaves its buffer. `what` names who wants it.
template <int N>
[[nodiscard]] std::vector<glm::vec<N, float>> read_vectors(const GltfFile& file, int accessor, const std::string& what);

/// The same for elements of any number of components, one behind the other.
[[nodiscard]] std::vector<float> read_numbers(const GltfFile& file, int accessor, std::size_t components,
                                              const std::string& what);

/// The elements of an accessor of unsigned scalars.
[[nodiscard]] std::vector<std::uint32_t> read_indices(const GltfFile& file, int accessor, const std::string& what);

}  // namespace claray
