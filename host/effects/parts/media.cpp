// What light passes between surfaces.
#include <array>

#include "host/bsdf/material_data.hpp"
#include "host/effects/nested_media.hpp"
#include "host/effects/parts/part.hpp"

namespace claray {
namespace {

void find_nested_media(const SearchedScene& searched, const Found& found) {
    for (const std::uint32_t medium : nested_media(searched.scene))
        found("material", searched.scene.materials[medium].name, medium);
}

void strip_nested_media(Scene& scene) {
    for (const std::uint32_t medium : nested_media(scene)) scene.materials[medium].kind = MaterialKind::lambert;
}

constexpr std::array medium_parts = {
    EffectPart{.effect = Effect::absorption,
               .in_material = absorbs_inside,
               .strip_material = [](Material& m) { m.attenuation_distance = 0.f; },
               .show =
                   [](Scene& s) {
                       make_glass(s);
                       ball_of(s).attenuation = {0.2f, 0.7f, 0.5f}, ball_of(s).attenuation_distance = 0.6f;
                   }},
    EffectPart{
        .effect = Effect::nested_media, .find = find_nested_media, .strip = strip_nested_media, .show = [](Scene& s) {
            make_glass(s);
            s.meshes.push_back(scenes::textured_ball({-0.35f, 0.8f, 0.f}, 0.4f, 3, scenes::block_material));
        }}};

}  // namespace

std::span<const EffectPart> parts_of_media() { return medium_parts; }

}  // namespace claray
