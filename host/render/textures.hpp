// The textures that a scene's materials use, in one buffer (include/claray/shared/texture.h).
#pragma once

#include "claray/buffer.hpp"
#include "claray/scene.hpp"
#include "claray/shared/texture.h"

namespace claray {

/// Not allocated where no used material has a map. Images that no map needs, texture coordinates that no map lies on
/// and mip maps that no filter reads are not uploaded.
struct Textures {
    Textures() = default;
    /// Throws ErrorKind::user where a map names no texture, or a texture has no size or another number of texels than
    /// its size says.
    Textures(const Device& device, const Scene& scene);

    Buffer<std::uint32_t> store;
    bool mipmaps = false;
    std::uint64_t texel_bytes = 0;  ///< of the store, mip maps included
};

/// Whether a map of this material is emission that varies over its triangles.
[[nodiscard]] bool has_emission_map(const Material& material);

}  // namespace claray
