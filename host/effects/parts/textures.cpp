// Images on surfaces and around the scene.
#include <array>

#include "host/bsdf/material_data.hpp"
#include "host/effects/parts/part.hpp"
#include "host/scene/builtin/shapes.hpp"
#include "host/textures/cutouts.hpp"

namespace claray {
namespace {

using scenes::add_texture, scenes::ball_material, scenes::block_material, scenes::floor_material;

const Texture& image_of(const TextureUse& use, const Scene& scene) {
    static const Texture none;
    return use.texture < scene.textures.size() ? scene.textures[use.texture] : none;
}

/// Tells of a map's image, if there is a map.
void tell_of(const TextureUse& use, const Scene& scene, const Found& found) {
    if (use.used()) found("texture", image_of(use, scene).name, use.texture);
}

/// Tells of the images of all maps but opacity for which `needs(image)` holds.
template <bool needs(const Texture&)>
void find_maps(const SearchedScene& searched, const Found& found) {
    for_each_material(searched, [&](const Material& m, std::size_t) {
        for (const auto map : material_maps)
            if ((m.*map).used() && needs(image_of(m.*map, searched.scene))) tell_of(m.*map, searched.scene, found);
    });
}

bool is_any(const Texture&) { return true; }
bool has_levels(const Texture& texture) { return reads_levels(texture.filter); }
bool reads_nearest_level(const Texture& texture) { return texture.filter == Filter::nearest_level; }

/// The direction of stretched highlights follows texture coordinates.
void find_textures(const SearchedScene& searched, const Found& found) {
    for_each_material(searched, [&](const Material& m, std::size_t i) {
        if (is_anisotropic(m)) found("material", m.name, i);
    });
    find_maps<is_any>(searched, found);
}

template <TextureUse Material::*map>
void find_map(const SearchedScene& searched, const Found& found) {
    for_each_material(searched, [&](const Material& m, std::size_t) { tell_of(m.*map, searched.scene, found); });
}

void find_normal_maps(const SearchedScene& searched, const Found& found) {
    for_each_material(searched, [&](const Material& m, std::size_t) {
        tell_of(m.normal_map, searched.scene, found);
        if (has_layered_coat(m)) tell_of(m.clearcoat_normal_map, searched.scene, found);
    });
}

void find_emission_maps(const SearchedScene& searched, const Found& found) {
    for_each_material(searched, [&](const Material& m, std::size_t) {
        if (sampled_emission(m) < 0.f) tell_of(m.emission_map, searched.scene, found);
    });
}

void find_cut_out_materials(const SearchedScene& searched, const Found& found) {
    const std::vector<bool> cut_outs = find_cut_outs(searched.scene, searched.used);
    for (std::size_t i = 0; i < cut_outs.size(); ++i)
        if (cut_outs[i]) found("material", searched.scene.materials[i].name, i);
}

void find_environment(const SearchedScene& searched, const Found& found) {
    const Environment& environment = searched.scene.environment;
    if (!environment.images.empty() && environment.strength > 0) found("environment", environment.images[0].name, 0);
}

void strip_textures(Material& m) {
    for (const auto map : material_maps) m.*map = {};
    m.opacity_map = {}, m.anisotropy = 0.f;
}

template <bool needs(const Texture&), Filter instead>
void change_filters(Scene& scene) {
    for (Texture& texture : scene.textures)
        if (needs(texture)) texture.filter = instead;
}

/// Checks on the floor, so small that far ones are blended.
template <Filter filter>
void show_levels(Scene& s) {
    TextureUse& use = s.materials[floor_material].albedo_map;
    use = add_texture(s, scenes::checks(), filter);
    use.scale = glm::vec2(12.f);
}

void show_height_maps(Scene& s) {
    s.materials[floor_material].height_map = add_texture(s, scenes::noise_as_height());
    s.materials[floor_material].height_scale = 0.4f;
}

void show_emission_maps(Scene& s) {
    s.sky = {};
    s.meshes.push_back(
        scenes::textured_rectangle({-0.2f, 1.3f, -2.f}, {1.4f, 0.f, 0.f}, {0.f, 0.8f, 0.f}, scenes::stage_materials));
    s.materials.push_back(scenes::lamp("screen", {9.f, 8.f, 7.f}));
    s.materials.back().emission_map = add_texture(s, scenes::checks());
}

void show_cut_outs(Scene& s) {
    s.materials[block_material].opacity_map = add_texture(s, scenes::disc_opacity());
    s.materials[block_material].alpha_mode = AlphaMode::mask;
    s.meshes[block_material] =
        scenes::textured_rectangle({1.05f, 0.7f, 0.5f}, {0.6f, 0.f, 0.15f}, {0.f, 0.7f, 0.f}, block_material);
}

void show_culling(Scene& s) {
    s.meshes[ball_material] = scenes::open_bowl({-0.35f, 0.8f, 0.f}, 0.8f, ball_material);
    s.meshes[ball_material].normals.clear();
    s.meshes.push_back(scenes::textured_ball({-0.35f, 0.5f, 0.1f}, 0.35f, 3, block_material));  // seen through its wall
    s.meshes.back().normals.clear();
    ball_of(s).cull_back = true;
}

constexpr std::array texture_parts = {
    EffectPart{.effect = Effect::environment,
               .find = find_environment,
               .strip = [](Scene& scene) { scene.environment = {}; },
               .show = replace_sky_by_evening},
    EffectPart{.effect = Effect::textures,
               .find = find_textures,
               .strip_material = strip_textures,
               .show = [](Scene& s) { s.materials[floor_material].albedo_map = add_texture(s, scenes::checks()); }},
    EffectPart{.effect = Effect::mip_maps,
               .find = find_maps<has_levels>,
               .strip = change_filters<has_levels, Filter::bilinear>,
               .show = show_levels<Filter::trilinear>},
    EffectPart{.effect = Effect::nearest_levels,
               .find = find_maps<reads_nearest_level>,
               .strip = change_filters<reads_nearest_level, Filter::trilinear>,
               .show = show_levels<Filter::nearest_level>},
    EffectPart{.effect = Effect::normal_maps,
               .find = find_normal_maps,
               .strip_material = [](Material& m) { m.normal_map = m.clearcoat_normal_map = {}; },
               .show = [](Scene& s) { ball_of(s).normal_map = add_texture(s, scenes::ripples_as_normals()); }},
    EffectPart{.effect = Effect::height_maps,
               .find = find_map<&Material::height_map>,
               .strip_material = [](Material& m) { m.height_map = {}; },
               .show = show_height_maps},
    EffectPart{.effect = Effect::emission_maps,
               .find = find_emission_maps,
               .strip_material = [](Material& m) { m.emission_map = {}; },
               .show = show_emission_maps},
    EffectPart{
        .effect = Effect::light_maps,
        .find = find_map<&Material::light_map>,
        .strip_material = [](Material& m) { m.light_map = {}; },
        .show = [](Scene& s) { s.materials[floor_material].light_map = add_texture(s, scenes::pool_of_light()); }},
    EffectPart{.effect = Effect::cut_outs,
               .find = find_cut_out_materials,
               .strip_material = [](Material& m) { m.alpha_mode = AlphaMode::opaque; },
               .show = show_cut_outs},
    EffectPart{.effect = Effect::culling,
               .in_material = [](const Material& m) { return m.cull_back; },
               .strip_material = [](Material& m) { m.cull_back = false; },
               .show = show_culling}};

}  // namespace

std::span<const EffectPart> parts_of_textures() { return texture_parts; }

}  // namespace claray
