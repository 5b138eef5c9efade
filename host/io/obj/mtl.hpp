// MTL materials to claray's.
#pragma once

#include <tiny_obj_loader.h>

#include <map>
#include <set>

#include "host/io/scene_textures.hpp"

namespace claray {

/// Chooses the kind by what the file says of light, as docs/formats.md tells, and takes the values over. Values outside
/// their range are moved into it, with a warning. No texture is read yet.
[[nodiscard]] Material material_from_mtl(const tinyobj::material_t& mtl, Warnings& warnings);

/// What a mesh without material is made of.
[[nodiscard]] Material grey_lambert(const std::string& name);

/// Loads the images that materials name and hangs them into these.
class MtlMaps {
public:
    /// `obj`: no image may leave its folder.
    MtlMaps(std::filesystem::path obj, Scene& scene, Warnings& warnings)
        : obj_(std::move(obj)), scene_(scene), textures_(scene), warnings_(warnings) {}

    /// `folder`: that of the MTL, to which names are relative.
    void add(Material& material, const tinyobj::material_t& mtl, const std::filesystem::path& folder);

    /// Height maps are measured in texels, once it is known how large these are in the scene: for every material with
    /// one from `bump`, by the area of its triangles over that of their texture coordinates.
    void scale_heights();

private:
    using Options = tinyobj::texture_option_t;
    /// Nothing where it is missing, with a warning for the first use.
    [[nodiscard]] std::optional<Texture> read(const std::filesystem::path& folder, const std::string& name,
                                              TexelFormat eight_bit, std::size_t room);
    [[nodiscard]] TextureUse color(const std::filesystem::path& folder, const std::string& name, const Options& options,
                                   TexelFormat eight_bit);
    [[nodiscard]] TextureUse scalar(const std::filesystem::path& folder, const std::string& name,
                                    const Options& options, bool prefer_alpha);
    void add_roughness_and_metallic(Material& material, const tinyobj::material_t& mtl,
                                    const std::filesystem::path& folder);
    void add_opacity(Material& material, const tinyobj::material_t& mtl, const std::filesystem::path& folder);
    void add_highlight(Material& material, const tinyobj::material_t& mtl, const std::filesystem::path& folder);
    void add_relief(Material& material, const tinyobj::material_t& mtl, const std::filesystem::path& folder);
    [[nodiscard]] bool holds_normals(const std::filesystem::path& folder, const std::string& name);
    [[nodiscard]] std::vector<double> texel_sizes() const;

    std::filesystem::path obj_;
    Scene& scene_;
    SceneTextures textures_;
    Warnings& warnings_;
    std::set<std::string> missing_, in_texels_;  ///< images; materials whose height is measured in texels
    std::map<std::string, bool> normals_;        ///< images that were looked at: whether they hold normals
    std::map<std::uint32_t, bool> cut_outs_;     ///< textures that were looked at: whether they are cut-outs
};

/// The text of an MTL as tinyobjloader takes it: keywords in their usual case; all numbers that may be left out;
/// options before the names of images, and these without quotation marks; white `Kd` beside `map_Kd` where it is left
/// out. Warns of statements that are left out, and of what is no finite number, for which 0 stands. `name`: in
/// warnings.
[[nodiscard]] std::string adapted_to_tinyobj(const std::string& mtl, const std::string& name, Warnings& warnings);

}  // namespace claray
