// What SceneChanges::sky changes.
#include <array>

#include "host/effects/parts/part.hpp"

namespace claray {
namespace {

void find_sky(const SearchedScene& searched, const Found& found) {
    if (is_lit(searched.scene.sky.horizon) || is_lit(searched.scene.sky.zenith)) found("sky", {}, 0);
}

constexpr std::array sky_parts = {EffectPart{.effect = Effect::sky,
                                             .find = find_sky,
                                             .strip = [](Scene& scene) { scene.sky = {}; },
                                             .show = [](Scene&) {},
                                             .apart = true}};

}  // namespace

std::span<const EffectPart> parts_of_sky() { return sky_parts; }

}  // namespace claray
