// What a texture is on average over a triangle.
#pragma once

#include "claray/texture.hpp"

namespace claray {

/// Mean colour between three corners in texture coordinates, of points spread evenly: about two for every texel, 256
/// at least and 1,024 at most. Of the texels as they are, without filtering.
[[nodiscard]] glm::vec3 mean_texel(const Texture& texture, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c);

}  // namespace claray
