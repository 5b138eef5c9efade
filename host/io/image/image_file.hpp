// Encoded images in memory to textures.
#pragma once

#include <string_view>

#include "claray/io.hpp"

namespace claray {

inline constexpr unsigned largest_image_side = 1u << 14;
inline constexpr std::size_t largest_image_bytes = std::size_t(1) << 30;  ///< decoded; of one image or all of a scene

/// What load_image does, with the bytes of the file already there. `what` names the image in errors; `room` is how many
/// bytes it may have when decoded.
[[nodiscard]] Texture decode_texture(std::string_view bytes, const std::string& what, TexelFormat eight_bit,
                                     std::size_t room = largest_image_bytes);

/// Bytes of the texels.
[[nodiscard]] inline std::size_t size_of(const Texture& texture) {
    return texture.bytes.size() + texture.floats.size() * sizeof(float);
}

}  // namespace claray
