// The value of a texture at a point, and its mean over a triangle.
#pragma once

#include "claray/texture.hpp"

namespace claray {

/// The texel at a point as linear RGBA: grey images have three equal channels; without alpha it is 1.
[[nodiscard]] glm::vec4 nearest_texel(const Texture& texture, const glm::vec2& uv);

/// Mean colour between three corners in texture coordinates, over evenly spread points: about two per texel, at least
/// 256 and at most `most_points`. Texels are not filtered.
[[nodiscard]] glm::vec3 mean_texel(const Texture& texture, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c,
                                   unsigned most_points = 1024);

}  // namespace claray
