// What light passes between surfaces.
#include <array>

#include "host/bsdf/material_data.hpp"
#include "host/effects/parts/part.hpp"

namespace claray {
namespace {

constexpr std::array medium_parts = {
    EffectPart{.effect = Effect::absorption,
               .in_material = absorbs_inside,
               .strip_material = [](Material& m) { m.attenuation_distance = 0.f; },
               .show =
                   [](Scene& s) {
                       make_glass(s);
                       ball_of(s).attenuation = {0.2f, 0.7f, 0.5f}, ball_of(s).attenuation_distance = 0.6f;
                   }}};

}  // namespace

std::span<const EffectPart> parts_of_media() { return medium_parts; }

}  // namespace claray
