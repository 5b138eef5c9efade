// Textures as materials use them.
#pragma once

#include "claray/scene.hpp"
#include "claray/shared/texture.h"

namespace claray {

/// The texture with that index, in a scene that `validate` accepts. Throws ErrorKind::user if it is larger than the
/// kernels' mip maps.
[[nodiscard]] const Texture& checked_texture(const Scene& scene, std::uint32_t index);

/// KHR_texture_transform as a matrix: scale, then rotate, then shift; `texture` is the index in the store.
[[nodiscard]] TextureUseData data_of(const TextureUse& use, std::uint32_t texture);
[[nodiscard]] glm::vec2 transformed(const TextureUse& use, const glm::vec2& uv);

/// For every material, whether a triangle or a primitive has it.
[[nodiscard]] std::vector<bool> used_materials(const Scene& scene);

/// One array for the vertices of all meshes; `none` for meshes without data.
template <class Vector>
std::vector<Vector> of_all_meshes(const Scene& scene, std::vector<Vector> Mesh::*member, Vector none = Vector(0.f)) {
    std::vector<Vector> all;
    for (const Mesh& mesh : scene.meshes) {
        const std::vector<Vector>& values = mesh.*member;
        all.insert(all.end(), values.begin(), values.end());
        if (values.empty()) all.resize(all.size() + mesh.positions.size(), none);
    }
    return all;
}

}  // namespace claray
