// Lobes and layers of principled materials, and emission.
#include <array>

#include "host/bsdf/material_data.hpp"
#include "host/effects/parts/part.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray {
namespace {

bool transmits(const Material& m) {
    return kind_of(m) == MaterialKind::principled && m.transmission > 0 && !m.thin_walled;
}

void show_coat(Scene& s) {
    make_principled(s), ball_of(s).clearcoat = 1.f, ball_of(s).roughness = 0.7f;
    replace_sky_by_evening(s);
}

void show_emissive_triangles(Scene& s) {
    s.sky = {};
    s.materials.push_back(scenes::lamp("lamp", {15.f, 13.f, 10.f}));
    s.meshes.push_back(scenes::make_lamp({-1.8f, 3.f, 2.2f}, {0.f, 0.5f, 0.f}, 0.6f, scenes::stage_materials));
}

constexpr std::array layer_parts = {
    EffectPart{.effect = Effect::emissive_triangles,
               .in_material = [](const Material& m) { return is_lit(m.emission); },
               .strip_material = [](Material& m) { m.emission = glm::vec3(0.f); },
               .show = show_emissive_triangles},
    EffectPart{
        .effect = Effect::transmission,
        .in_material = transmits,
        .strip_material = [](Material& m) { m.transmission = 0.f, m.transmission_map = {}; },
        .show = [](Scene& s) { make_principled(s), ball_of(s).transmission = 0.9f, ball_of(s).roughness = 0.f; }},
    EffectPart{.effect = Effect::rough_glass,
               .in_material = has_rough_glass,
               .strip_material = [](Material& m) { m.roughness = m.clearcoat_roughness = 0.f; },
               .show = [](Scene& s) { make_glass(s), ball_of(s).roughness = 0.4f; }},
    EffectPart{.effect = Effect::clearcoat,
               .in_material = has_clearcoat,
               .strip_material = [](Material& m) { m.clearcoat = 0.f, m.clearcoat_map = {}; },
               .show = show_coat},
    EffectPart{.effect = Effect::layered_coat,
               .in_material = has_layered_coat,
               .strip_material = [](Material& m) { m.clearcoat = 0.f; },
               .show =
                   [](Scene& s) {
                       show_coat(s), ball_of(s).normal_map = scenes::add_texture(s, scenes::ripples_as_normals());
                   }},
    EffectPart{.effect = Effect::specular,
               .in_material = has_specular_layer,
               .strip_material =
                   [](Material& m) {
                       m.specular_weight = 1.f, m.specular_tint = glm::vec3(1.f);
                       m.specular_map = m.specular_weight_map = {};
                   },
               .show =
                   [](Scene& s) {
                       make_principled(s), ball_of(s).albedo = glm::vec3(0.02f);
                       ball_of(s).specular_tint = {20.f, 12.f, 4.f};
                   }},
    EffectPart{
        .effect = Effect::iridescence,
        .in_material = has_film,
        .strip_material = [](Material& m) { m.iridescence = 0.f, m.iridescence_map = m.film_thickness_map = {}; },
        .show =
            [](Scene& s) {
                make_principled(s), ball_of(s).albedo = glm::vec3(0.02f), ball_of(s).roughness = 0.1f;
                ball_of(s).iridescence = 1.f, ball_of(s).iridescence_ior = 2.f, ball_of(s).film_thickness.y = 380.f;
            }},
    EffectPart{.effect = Effect::anisotropy,
               .in_material = is_anisotropic,
               .strip_material = [](Material& m) { m.anisotropy = 0.f, m.anisotropy_map = {}; },
               .show =
                   [](Scene& s) {
                       set_kind(s, MaterialKind::principled, {1.f, 0.71f, 0.29f}, 0.3f);
                       ball_of(s).metallic = 1.f, ball_of(s).anisotropy = 0.9f;
                       replace_sky_by(s, LightKind::point);
                   }},
    EffectPart{
        .effect = Effect::sheen,
        .in_material = has_sheen,
        .strip_material = [](Material& m) { m.sheen = glm::vec3(0.f), m.sheen_map = m.sheen_roughness_map = {}; },
        .show =
            [](Scene& s) {
                make_principled(s), ball_of(s).albedo = {0.2f, 0.02f, 0.05f}, ball_of(s).roughness = 1.f;
                ball_of(s).sheen = {1.f, 0.6f, 0.7f}, ball_of(s).sheen_roughness = 0.4f;
            }}};

}  // namespace

std::span<const EffectPart> parts_of_layers() { return layer_parts; }

}  // namespace claray
