// Which point of a mesh each texel of its light map shows.
#pragma once

#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/types.h"

namespace claray {

struct TexelPoints {
    std::vector<std::uint32_t> texels;  ///< those that show the mesh
    std::vector<Hit> points;            ///< of each: u, v and the triangle, counted from `first_triangle`
};

/// The point under a texel's centre or, where the centre misses the mesh by less than a texel, the nearest one. Throws
/// ErrorKind::user where `uvs` leave 0..1 or triangles lie above each other; `name` is the mesh in messages.
[[nodiscard]] TexelPoints find_texel_points(const Mesh& mesh, const std::vector<glm::vec2>& uvs, unsigned width,
                                            unsigned height, std::uint32_t first_triangle, const std::string& name);

}  // namespace claray
