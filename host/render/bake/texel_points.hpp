// Finds the point of a mesh that each texel of its light map shows.
#pragma once

#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/types.h"

namespace claray {

struct TexelPoints {
    std::vector<std::uint32_t> texels;  ///< texels that show the mesh
    std::vector<Hit> points;            ///< for each: u, v and the triangle, counted from `first_triangle`
};

/// The point under a texel's centre or, if the centre misses the mesh by less than a texel, the nearest one. Throws
/// ErrorKind::user if `uvs` leave 0..1 or triangles overlap; `name` is the mesh in messages.
[[nodiscard]] TexelPoints find_texel_points(const Mesh& mesh, const std::vector<glm::vec2>& uvs, unsigned width,
                                            unsigned height, std::uint32_t first_triangle, const std::string& name);

}  // namespace claray
