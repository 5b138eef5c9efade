// glTF materials and their textures to claray's.
#pragma once

#include <functional>

#include "host/io/gltf/gltf_mesh.hpp"
#include "host/io/gltf/materials/gltf_images.hpp"
#include "host/io/scene_textures.hpp"

namespace claray {

/// Makes the materials that are asked for, and loads the images that these use.
class GltfMaterials {
public:
    GltfMaterials(const GltfFile& file, Scene& scene, Warnings& warnings, const GltfImages& images)
        : file_(file),
          scene_(scene),
          warnings_(warnings),
          textures_(scene),
          images_(images),
          known_(file.model.materials.size() + 1, unknown) {}

    /// Index in the scene of a material of the file; -1 is the format's default. `user` names who wants it.
    [[nodiscard]] std::uint32_t index_of(int material, const std::string& user);

    /// The sets of coordinates of the file that a material of the scene has as its first and its second.
    [[nodiscard]] const GltfUvSets& uv_sets(std::uint32_t material) const { return uv_sets_.at(material); }

private:
    static constexpr std::uint32_t unknown = 0xffffffffu;
    static constexpr int no_set = -1;

    [[nodiscard]] Material make(const tinygltf::Material& source, const std::string& name);
    void add_extensions(Material& material, const tinygltf::Material& source, const std::string& name);
    void add_transmission(Material& material, const tinygltf::ExtensionMap& all, const std::string& name);
    void add_clearcoat(Material& material, const tinygltf::Value& clearcoat, const std::string& name);
    void add_specular(Material& material, const tinygltf::Value& specular, const std::string& name);
    void add_sheen(Material& material, const tinygltf::Value& sheen, const std::string& name);
    void add_anisotropy(Material& material, const tinygltf::Value& anisotropy, const std::string& name);
    void add_iridescence(Material& material, const tinygltf::Value& iridescence, const std::string& name);
    void add_glossiness(Material& material, const tinygltf::Value& glossiness, const std::string& name);
    /// What becomes of an image before it is a texture; `name` tells it from others.
    struct Change {
        std::string name;
        std::function<Texture(Texture)> apply;
    };
    [[nodiscard]] TextureUse use(int index, int uv_set, const tinygltf::ExtensionMap& extensions, TexelFormat format,
                                 const std::string& user, const Change& change = {});
    [[nodiscard]] TextureUse use(const tinygltf::Value& extension, const char* key, const std::string& user,
                                 TexelFormat format = TexelFormat::linear8, const Change& change = {});
    [[nodiscard]] std::optional<std::uint32_t> slot_of(int uv_set);
    [[nodiscard]] int source_of(const tinygltf::Texture& texture, const std::string& name) const;
    [[nodiscard]] std::optional<std::uint32_t> texture(int index, TexelFormat format, const std::string& user,
                                                       const Change& change);

    const GltfFile& file_;
    Scene& scene_;
    Warnings& warnings_;
    SceneTextures textures_;
    const GltfImages& images_;
    std::vector<std::uint32_t> known_;  ///< by index in the file; the last is the default's
    GltfUvSets used_sets_{};            ///< of the material that is made
    std::vector<GltfUvSets> uv_sets_;   ///< by index in the scene
};

}  // namespace claray
