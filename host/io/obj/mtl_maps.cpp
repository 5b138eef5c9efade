// The images of MTL materials.
#include <algorithm>
#include <cmath>

#include "host/io/image/image_file.hpp"
#include "host/io/obj/mtl.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

/// MTL: uv' = uv * s + o, v from the bottom. From the top, 1 - v, the same reads v' = s v + (1 - s - o).
TextureUse use_of(std::optional<std::uint32_t> texture, const tinyobj::texture_option_t& options) {
    TextureUse use;
    if (!texture) return use;
    use.texture = *texture;
    use.scale = {options.scale[0], options.scale[1]};
    use.offset = {options.origin_offset[0], 1.f - options.scale[1] - options.origin_offset[1]};
    return use;
}

TextureSettings settings_of(const tinyobj::texture_option_t& options, TexelFormat eight_bit) {
    TextureSettings settings;
    settings.eight_bit = eight_bit;
    settings.wrap_u = settings.wrap_v = options.clamp ? Wrap::clamp : Wrap::repeat;
    return settings;
}

/// A texel's value in 0..1, as stored.
float stored(const Texture& t, std::size_t texel, unsigned channel) {
    const std::size_t i = texel * t.channels + channel;
    return t.format == TexelFormat::float32 ? t.floats[i] : float(t.bytes[i]) / 255.f;
}

std::size_t texel_count(const Texture& t) { return std::size_t(t.width) * t.height; }
bool has_alpha(const Texture& t) { return t.channels % 2 == 0; }

bool is_all_opaque(const Texture& t) {
    for (std::size_t i = 0; i < texel_count(t); ++i)
        if (stored(t, i, t.channels - 1) < 1.f) return false;
    return true;
}

/// One channel of an image: what -imfchan names, or else its luminance (Rec. 709); alpha where that is preferred and
/// says something.
Texture one_channel(const Texture& from, char channel, bool prefer_alpha) {
    Texture to;
    to.name = from.name, to.width = from.width, to.height = from.height, to.channels = 1, to.format = from.format;
    const bool alpha = prefer_alpha && has_alpha(from) && !is_all_opaque(from);
    const unsigned named = channel == 'g' ? 1 : channel == 'b' ? 2 : 0;
    const bool by_name = from.channels >= 3 && (channel == 'r' || channel == 'g' || channel == 'b');
    for (std::size_t i = 0; i < texel_count(from); ++i) {
        float value = stored(from, i, alpha ? from.channels - 1 : by_name ? named : 0);
        if (!alpha && !by_name && from.channels >= 3)
            value = 0.2126f * value + 0.7152f * stored(from, i, 1) + 0.0722f * stored(from, i, 2);
        if (from.format == TexelFormat::float32)
            to.floats.push_back(value);
        else
            to.bytes.push_back(std::uint8_t(std::lround(value * 255.f)));
    }
    return to;
}

/// MTL takes opacity from `map_d` alone.
Texture without_alpha(Texture t) {
    if (!has_alpha(t)) return t;
    const auto drop = [&](auto& values) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (i % t.channels != t.channels - 1) values[kept++] = values[i];
        values.resize(kept);
        values.shrink_to_fit();
    };
    drop(t.bytes);
    drop(t.floats);
    --t.channels;
    return t;
}

/// The value at (x, y) of the grey image `from`, stretched over a grid of `width` x `height`; 1 without an image.
float stretched(const Texture& from, unsigned x, unsigned y, unsigned width, unsigned height) {
    if (from.width == 0) return 1.f;
    const std::size_t column = std::size_t(x) * from.width / width, row = std::size_t(y) * from.height / height;
    return stored(from, row * from.width + column, 0);
}

/// glTF's packing: roughness in green, metallic in blue.
Texture packed(const Texture& roughness, const Texture& metallic) {
    Texture to;
    to.name = roughness.width ? roughness.name : metallic.name;
    to.width = std::max(roughness.width, metallic.width), to.height = std::max(roughness.height, metallic.height);
    to.channels = 3, to.format = TexelFormat::linear8;
    for (unsigned y = 0; y < to.height; ++y)
        for (unsigned x = 0; x < to.width; ++x) {
            to.bytes.push_back(0);
            for (const Texture* from : {&roughness, &metallic}) {
                const float value = std::clamp(stretched(*from, x, y, to.width, to.height), 0.f, 1.f);
                to.bytes.push_back(std::uint8_t(std::lround(value * 255.f)));
            }
        }
    return to;
}

/// Cut-outs are all there or not at all but for their edges.
bool is_cut_out(const Texture& t, unsigned channel) {
    std::size_t between = 0;
    for (std::size_t i = 0; i < texel_count(t); ++i) {
        const float value = stored(t, i, channel);
        between += value > 0.1f && value < 0.9f;
    }
    return between * 10 <= texel_count(t);
}

/// Many files give a normal map to `bump`: it is mostly blue.
bool looks_like_normals(const Texture& t) {
    if (t.channels < 3) return false;
    glm::dvec3 mean(0.0);
    for (std::size_t i = 0; i < texel_count(t); ++i)
        for (unsigned k = 0; k < 3; ++k) mean[int(k)] += double(stored(t, i, k));
    mean /= double(texel_count(t));
    return mean.z > 0.7 && std::abs(mean.x - 0.5) < 0.15 && std::abs(mean.y - 0.5) < 0.15;
}

}  // namespace

std::optional<Texture> MtlMaps::read(const fs::path& folder, const std::string& name, TexelFormat eight_bit,
                                     std::size_t room) {
    const std::string path = (folder / name).string();
    if (missing_.contains(path)) return {};
    const std::optional<ImageFile> file = read_image_of_scene(obj_, folder, name, warnings_);
    if (!file) {
        missing_.insert(path);
        return {};
    }
    Texture texture = decode_texture(file->bytes, file->name, eight_bit, room);
    texture.name = name;
    return texture;
}

TextureUse MtlMaps::color(const fs::path& folder, const std::string& name, const Options& options,
                          TexelFormat eight_bit) {
    if (name.empty()) return {};
    if (options.colorspace == "linear") eight_bit = TexelFormat::linear8;
    const auto decode = [&](TexelFormat format, std::size_t room) {
        std::optional<Texture> texture = read(folder, name, format, room);
        return texture ? without_alpha(*std::move(texture)) : texture;
    };
    return use_of(textures_.add((folder / name).string(), settings_of(options, eight_bit), decode), options);
}

TextureUse MtlMaps::scalar(const fs::path& folder, const std::string& name, const Options& options, bool prefer_alpha) {
    const std::string key = (folder / name).string() + (prefer_alpha ? " alpha " : " channel ") + options.imfchan;
    const auto decode = [&](TexelFormat format, std::size_t room) {
        const std::optional<Texture> texture = read(folder, name, format, room);
        return texture ? one_channel(*texture, options.imfchan, prefer_alpha) : texture;
    };
    return use_of(textures_.add(key, settings_of(options, TexelFormat::linear8), decode), options);
}

void MtlMaps::add_roughness_and_metallic(Material& material, const tinyobj::material_t& mtl, const fs::path& folder) {
    const std::string &roughness = mtl.roughness_texname, &metallic = mtl.metallic_texname;
    if (material.kind != MaterialKind::principled || (roughness.empty() && metallic.empty())) return;
    const Options& options = roughness.empty() ? mtl.metallic_texopt : mtl.roughness_texopt;
    const auto decode = [&](TexelFormat format, std::size_t room) {
        const auto grey = [&](const std::string& name, const Options& its) {
            const std::optional<Texture> texture = name.empty() ? std::nullopt : read(folder, name, format, room);
            return texture ? one_channel(*texture, its.imfchan, false) : Texture();
        };
        const Texture of_roughness = grey(roughness, mtl.roughness_texopt),
                      of_metal = grey(metallic, mtl.metallic_texopt);
        const bool none = of_roughness.width == 0 && of_metal.width == 0;
        return none ? std::nullopt : std::optional(packed(of_roughness, of_metal));
    };
    const std::string key = (folder / roughness).string() + " and " + (folder / metallic).string();
    material.metallic_roughness_map =
        use_of(textures_.add(key, settings_of(options, TexelFormat::linear8), decode), options);
}

void MtlMaps::add_opacity(Material& material, const tinyobj::material_t& mtl, const fs::path& folder) {
    if (mtl.alpha_texname.empty()) return;
    material.opacity_map = scalar(folder, mtl.alpha_texname, mtl.alpha_texopt, true);
    if (!material.opacity_map.used()) return;
    const std::uint32_t texture = material.opacity_map.texture;
    const auto [known, is_new] = cut_outs_.try_emplace(texture);
    if (is_new) known->second = is_cut_out(scene_.textures[texture], 0);
    material.alpha_mode = known->second && material.opacity == 1.f ? AlphaMode::mask : AlphaMode::blend;
}

bool MtlMaps::holds_normals(const fs::path& folder, const std::string& name) {
    const auto [known, is_new] = normals_.try_emplace((folder / name).string());
    if (is_new) {
        const std::optional<Texture> image = read(folder, name, TexelFormat::linear8, largest_image_bytes);
        known->second = image && looks_like_normals(*image);
    }
    return known->second;
}

void MtlMaps::add_relief(Material& material, const tinyobj::material_t& mtl, const fs::path& folder) {
    material.normal_map = color(folder, mtl.normal_texname, mtl.normal_texopt, TexelFormat::linear8);
    if (material.normal_map.used()) {
        material.normal_scale = mtl.normal_texopt.bump_multiplier;
        return;
    }
    const bool bump = !mtl.bump_texname.empty();
    const std::string& name = bump ? mtl.bump_texname : mtl.displacement_texname;
    const Options& options = bump ? mtl.bump_texopt : mtl.displacement_texopt;
    if (name.empty()) return;
    if (bump && holds_normals(folder, name)) {
        warnings_.push_back("material '" + mtl.name + "': its bump map '" + name +
                            "' contains normals and is used as a normal map");
        material.normal_map = color(folder, name, options, TexelFormat::linear8);
        material.normal_scale = options.bump_multiplier;
        return;
    }
    material.height_map = scalar(folder, name, options, false);
    if (!material.height_map.used()) return;
    material.height_scale = options.contrast * (bump ? options.bump_multiplier : 1.f);
    if (bump) in_texels_.insert(material.name);
}

void MtlMaps::add_highlight(Material& material, const tinyobj::material_t& mtl, const fs::path& folder) {
    if (material.kind != MaterialKind::blinn_phong) return;
    material.specular_map = color(folder, mtl.specular_texname, mtl.specular_texopt, TexelFormat::srgb8);
    if (!mtl.specular_highlight_texname.empty())
        material.shininess_map = scalar(folder, mtl.specular_highlight_texname, mtl.specular_highlight_texopt, false);
}

void MtlMaps::add(Material& material, const tinyobj::material_t& mtl, const fs::path& folder) {
    const bool mirrors = material.kind == MaterialKind::mirror || material.kind == MaterialKind::metal;
    const bool by_specular = mirrors && mtl.metallic < 0.5f;  // its colour is Ks
    if (material.kind != MaterialKind::glass) {
        const std::string& name = by_specular ? mtl.specular_texname : mtl.diffuse_texname;
        const Options& options = by_specular ? mtl.specular_texopt : mtl.diffuse_texopt;
        material.albedo_map = color(folder, name, options, TexelFormat::srgb8);
        if (!name.empty()) show_missing(material);
    }
    add_highlight(material, mtl, folder);
    const bool has_highlight = material.kind == MaterialKind::blinn_phong;
    if (!by_specular && !mtl.specular_texname.empty() && !has_highlight)
        warnings_.push_back("material '" + mtl.name +
                            "': map_Ks is ignored, since illum and the other keys define no highlight");
    if (!mtl.specular_highlight_texname.empty() && !has_highlight)
        warnings_.push_back("material '" + mtl.name +
                            "': map_Ns is ignored, since illum and the other keys define no highlight");
    material.emission_map = color(folder, mtl.emissive_texname, mtl.emissive_texopt, TexelFormat::srgb8);
    if (material.emission_map.used() && material.emission == glm::vec3(0.f)) material.emission = glm::vec3(1.f);
    if (!mtl.emissive_texname.empty() && !material.emission_map.used()) material.emission = glm::vec3(0.f);
    add_roughness_and_metallic(material, mtl, folder);
    add_opacity(material, mtl, folder);
    add_relief(material, mtl, folder);
}

/// Of each material: the root of the area of its triangles over that of their texture coordinates, 0 without any.
std::vector<double> MtlMaps::texel_sizes() const {
    std::vector<glm::dvec2> areas(scene_.materials.size(), glm::dvec2(0.0));
    for (const Mesh& mesh : scene_.meshes) {
        for (std::size_t i = 0; i < mesh.triangles.size() && !mesh.uvs.empty(); ++i) {
            const glm::uvec3& t = mesh.triangles[i];
            const glm::dvec3 p(mesh.positions[t.x]);
            const glm::dvec2 a(mesh.uvs[t.y] - mesh.uvs[t.x]), b(mesh.uvs[t.z] - mesh.uvs[t.x]);
            const double area =
                glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - p, glm::dvec3(mesh.positions[t.z]) - p));
            if (std::isfinite(area)) areas[mesh.materials[i]] += glm::dvec2(area, std::abs(a.x * b.y - a.y * b.x));
        }
    }
    std::vector<double> sizes;
    for (const glm::dvec2& area : areas) sizes.push_back(area.y > 0.0 ? std::sqrt(area.x / area.y) : 0.0);
    return sizes;
}

void MtlMaps::scale_heights() {
    if (in_texels_.empty()) return;
    const std::vector<double> sizes = texel_sizes();
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        Material& material = scene_.materials[i];
        if (!in_texels_.contains(material.name)) continue;
        const double repeats =
            std::abs(double(material.height_map.scale.x)) * scene_.textures[material.height_map.texture].width;
        const double texel = repeats > 0.0 ? sizes[i] / repeats : 0.0;
        if (texel > 0.0 && std::isfinite(texel)) material.height_scale *= float(texel);
    }
}

}  // namespace claray
