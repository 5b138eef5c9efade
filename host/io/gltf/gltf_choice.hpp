// Things of a glTF that a user chooses by name or by index.
#pragma once

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

/// Index of the name that is `choice`, else `choice` itself as an index. Throws ErrorKind::usage with the names that
/// there are. `kind` is "animation", for instance.
[[nodiscard]] std::size_t choose(const GltfFile& file, const char* kind, const std::string& choice,
                                 const std::vector<std::string>& names);

/// "'Walk', 'Run', 2", the unnamed by their indices, and "... (60 in all)" where that gets long.
[[nodiscard]] std::string listed(const std::vector<std::string>& names);

/// The names of all elements of an array of the file.
template <class Elements>
[[nodiscard]] std::vector<std::string> names_of(const Elements& elements) {
    std::vector<std::string> names;
    for (const auto& element : elements) names.push_back(element.name);
    return names;
}

}  // namespace claray
