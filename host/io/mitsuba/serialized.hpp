// Mitsuba's binary meshes (.serialized, versions 3 and 4): several in a file, compressed by zlib.
#pragma once

#include <filesystem>

#include "claray/mesh.hpp"

namespace claray {

/// The mesh of this index, with normals and coordinates if it has any. Throws ErrorKind::user, naming the file, if it
/// is damaged or of another version.
[[nodiscard]] Mesh load_serialized(const std::filesystem::path& path, std::size_t index);

}  // namespace claray
