// Textures for tests.
#pragma once

#include "claray/scene.hpp"

namespace claray::test {

/// Random values over the whole range; floats between 0 and 1.
[[nodiscard]] Texture random_texture(glm::uvec2 size, unsigned channels, TexelFormat format, std::uint64_t seed);

/// Floats from a function of the texel's centre in texture coordinates.
template <class Function>
[[nodiscard]] Texture float_texture(glm::uvec2 size, Function&& value) {
    Texture t;
    t.width = size.x, t.height = size.y, t.channels = 3, t.format = TexelFormat::float32, t.filter = Filter::bilinear;
    for (unsigned y = 0; y < size.y; ++y)
        for (unsigned x = 0; x < size.x; ++x) {
            const glm::vec3 c(value((double(x) + 0.5) / size.x, (double(y) + 0.5) / size.y));
            for (int k = 0; k < 3; ++k) t.floats.push_back(c[k]);
        }
    return t;
}

/// White Lambert.
[[nodiscard]] Material lambert_material();
/// White Lambert whose albedo is the texture.
[[nodiscard]] Material textured(std::uint32_t texture);

/// A square of side 2 in y = 0, its normal (0, 1, 0); u grows with x and v with z, from 0 to 1.
[[nodiscard]] Mesh mapped_square(std::uint32_t material = 0);

}  // namespace claray::test
