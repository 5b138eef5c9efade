// The textures that a scene's materials use, in one buffer (include/claray/shared/texture.h).
#pragma once

#include "claray/buffer.hpp"
#include "claray/scene.hpp"
#include "claray/shared/texture.h"

namespace claray {

/// Not allocated if no used material has a map, no vertex has a colour, and nothing is cut out. Images, texture
/// coordinates and mip maps that are not used are not uploaded.
struct Textures {
    Textures() = default;
    /// For a scene that `validate` accepts; `with_cutouts`: as if something were cut out, even if nothing is. Throws
    /// ErrorKind::user if a texture has more than 2^14 texels along a side.
    Textures(const Device& device, const Scene& scene, bool with_cutouts = false);

    Buffer<std::uint32_t> store;
    bool mipmaps = false;
    bool has_maps = false;          ///< shading kernels need the store
    bool has_cutouts = false;       ///< rays pass through some triangles: the structure needs the store
    bool culls_back_faces = false;  ///< all triangles are one-sided, so that queries cull back faces
    std::uint64_t texel_bytes = 0;  ///< of the store, including mip maps

    /// The store for shading kernels.
    [[nodiscard]] Buffer<std::uint32_t> maps() const { return has_maps ? store : Buffer<std::uint32_t>(); }
    /// The store for `set_cutouts` of structures.
    [[nodiscard]] Buffer<std::uint32_t> cutouts() const { return has_cutouts ? store : Buffer<std::uint32_t>(); }
};

/// The maps that a material has: bits of CLARAY_ALBEDO_MAP and so on.
[[nodiscard]] std::uint32_t bits_of_maps(const Material& material);

/// Returns whether the colour of some vertex changes the albedo.
[[nodiscard]] bool has_colors(const Mesh& mesh);

}  // namespace claray
