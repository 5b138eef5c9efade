// The textures that a scene's materials use, in one buffer (include/claray/shared/texture.h).
#pragma once

#include "claray/buffer.hpp"
#include "claray/scene.hpp"
#include "claray/shared/texture.h"

namespace claray {

/// Not allocated where no used material has a map, no vertex a colour, and nothing is cut out. Images that no map
/// needs, texture coordinates that no map lies on and mip maps that no filter reads are not uploaded.
struct Textures {
    Textures() = default;
    /// For a scene that `validate` accepts; `with_cutouts`: as if something were cut out, even if nothing is. Throws
    /// ErrorKind::user where a texture has more than 2^14 texels a side.
    Textures(const Device& device, const Scene& scene, bool with_cutouts = false);

    Buffer<std::uint32_t> store;
    bool mipmaps = false;
    bool has_maps = false;          ///< the store is to be given to kernels that shade
    bool has_cutouts = false;       ///< rays pass through some triangles: the store is to be given to the structure
    bool culls_back_faces = false;  ///< all triangles have only a front, which queries are told
    std::uint64_t texel_bytes = 0;  ///< of the store, mip maps included

    /// What kernels that shade are given.
    [[nodiscard]] Buffer<std::uint32_t> maps() const { return has_maps ? store : Buffer<std::uint32_t>(); }
    /// What structures are given by `set_cutouts`.
    [[nodiscard]] Buffer<std::uint32_t> cutouts() const { return has_cutouts ? store : Buffer<std::uint32_t>(); }
};

/// Whether some vertex' colour changes the albedo.
[[nodiscard]] bool has_colors(const Mesh& mesh);

}  // namespace claray
