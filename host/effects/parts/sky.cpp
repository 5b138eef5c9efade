// What SceneChanges::sky changes.
#include <array>

#include "host/effects/parts/part.hpp"

namespace claray {
namespace {

void find_sky(const SearchedScene& searched, const Found& found) {
    if (is_lit(searched.scene.sky.horizon) || is_lit(searched.scene.sky.zenith)) found("sky", {}, 0);
}

void find_fog(const SearchedScene& searched, const Found& found) {
    if (searched.scene.sky.fog_density > 0) found("sky", {}, 0);
}

constexpr std::array sky_parts = {
    EffectPart{.effect = Effect::fog,
               .find = find_fog,
               .strip = [](Scene& scene) { scene.sky.fog_density = 0.f; },
               .show =
                   [](Scene& s) {
                       s.sky.fog_color = {0.6f, 0.65f, 0.7f};
                       s.sky.fog_density = 0.15f, s.sky.fog_depth = 8.f;
                   },
               .apart = true},
    EffectPart{.effect = Effect::sky,
               .find = find_sky,
               .strip = [](Scene& scene) { scene.sky.horizon = scene.sky.zenith = glm::vec3(0.f); },
               .show = [](Scene&) {},
               .apart = true}};

}  // namespace

std::span<const EffectPart> parts_of_sky() { return sky_parts; }

}  // namespace claray
