// Images on the host, for surfaces and the environment.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// How a coordinate outside 0..1 is mapped into it.
enum class Wrap : std::uint32_t { repeat, mirror, clamp };

enum class Filter : std::uint32_t {
    nearest,       ///< the texel that contains the point
    bilinear,      ///< interpolates four texels of the finest level
    trilinear,     ///< interpolates the two mip levels that match the ray's footprint
    nearest_level  ///< bilinear in the mip level that matches it best (OpenGL's LINEAR_MIPMAP_NEAREST)
};
[[nodiscard]] constexpr bool reads_levels(Filter filter) { return filter >= Filter::trilinear; }

/// Meaning of the stored numbers.
enum class TexelFormat : std::uint32_t {
    srgb8,    ///< bytes; colour by the sRGB curve, alpha linear
    linear8,  ///< bytes, 255 is 1
    float32   ///< linear, unbounded
};

/// Texels row by row from the top left. (u, v) = (0, 0) is the top left corner of the image (glTF's convention). OBJ
/// coordinates start at the bottom left; the OBJ loader converts them.
struct Texture {
    std::string name = {};
    unsigned width = 0, height = 0;
    unsigned channels = 4;  ///< 1 to 4 per texel: grey, grey and alpha, RGB, RGBA
    TexelFormat format = TexelFormat::srgb8;
    std::vector<std::uint8_t> bytes = {};  ///< width * height * channels values for srgb8 and linear8
    std::vector<float> floats = {};        ///< the same number of values for float32
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    Filter filter = Filter::trilinear;
};

inline constexpr std::uint32_t no_texture = 0xffffffffu;

/// How a material uses a texture: uv' = rotate(uv * scale, rotation) + offset (KHR_texture_transform).
struct TextureUse {
    std::uint32_t texture = no_texture;  ///< index into Scene::textures
    std::uint32_t uv_set = 0;            ///< 0: Mesh::uvs, 1: Mesh::uvs1
    glm::vec2 offset{0.f}, scale{1.f};
    float rotation = 0.f;  ///< radians, counter-clockwise as the image is seen
    [[nodiscard]] bool used() const { return texture != no_texture; }
};

}  // namespace claray
#pragma GCC visibility pop
