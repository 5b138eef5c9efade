// The value of a texture at a point, and its mean over a triangle.
#pragma once

#include "claray/texture.hpp"

namespace claray {

/// The texel at a point as linear RGBA: grey in all three where there is no colour, alpha 1 where there is none.
[[nodiscard]] glm::vec4 nearest_texel(const Texture& texture, const glm::vec2& uv);

/// Mean colour between three corners in texture coordinates, of points spread evenly: about two for every texel, 256
/// at least and `most_points` at most. Of the texels as they are, without filtering.
[[nodiscard]] glm::vec3 mean_texel(const Texture& texture, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c,
                                   unsigned most_points = 1024);

}  // namespace claray
