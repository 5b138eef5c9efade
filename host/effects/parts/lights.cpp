// Lights of Scene::lights, and the aids that choose among them.
#include <array>

#include "claray/mesh.hpp"
#include "host/effects/parts/part.hpp"
#include "host/lights/hot_spots.hpp"
#include "host/lights/lights.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray {
namespace {

template <LightKind kind>
bool is_light_of(const Light& light) {
    return light.kind == kind;
}

template <LightKind kind>
void strip_lights_of(Scene& scene) {
    std::erase_if(scene.lights, is_light_of<kind>);
}

/// A light of the kind over the ball.
template <LightKind kind>
void show_light(Scene& s) {
    Light& light = replace_sky_by(s, kind);
    constexpr LightTraits traits = *traits_of(kind);
    if (traits.far) {
        light.direction = {0.6f, -1.f, -0.5f}, light.intensity = glm::vec3(3.f, 2.8f, 2.4f);
    } else if (traits.cone) {
        light.direction = glm::vec3(0.1f, 0.4f, 0.1f) - light.position;
        light.intensity *= 2.f;
    }
    if (traits.cone) light.inner_angle = 0.15f, light.outer_angle = 0.33f;
}

Light& make_light_with_range(Scene& s, const glm::vec3& attenuation) {
    Light& light = replace_sky_by(s, LightKind::point);
    light.attenuation = attenuation, light.intensity = glm::vec3(6.f), light.range = 4.5f;
    return light;
}

/// `side` rows of as many small lights of many colours above the floor, none of them close to the ball or the block.
template <int side>
void show_rows_of_lights(Scene& s) {
    Bounds block;
    for (const glm::vec3& p : s.meshes[scenes::block_material].positions) block.grow(p - 0.25f), block.grow(p + 0.25f);
    const auto within = [](const glm::vec3& at, const Bounds& box) {
        return glm::all(glm::lessThan(box.lo, at)) && glm::all(glm::lessThan(at, box.hi));
    };
    s.sky = {};
    for (int i = 0; i < side * side; ++i) {
        const glm::vec3 color(float(1 + i % 3), float(1 + i % 4), float(1 + i % 5));
        const glm::vec2 share = glm::vec2(i % side, i / side) / float(side - 1);
        const glm::vec3 at(4.5f * share.x - 2.2f, 0.25f, 4.5f * share.y - 2.6f);
        if (glm::length(at - glm::vec3(-0.35f, 0.8f, 0.f)) > 1.1f && !within(at, block))
            s.lights.push_back(point_light(at, 2.4f / (side * side) * color));
    }
}

void find_light_lists(const SearchedScene& searched, const Found& found) {
    if (may_have_lists(searched.scene)) found("scene", searched.scene.name, 0);
}
void find_many_lights(const SearchedScene& searched, const Found& found) {
    if (near_lights(searched.scene) >= LightSelection{}.for_a_tree) found("scene", searched.scene.name, 0);
}
void find_lights_of_hot_spots(const SearchedScene& searched, const Found& found) {
    for (const HotSpotPlace& place : find_hot_spots(searched.scene))
        found("light", searched.scene.lights[place.light].name, place.light);
}

constexpr std::array light_parts = {
#define CLARAY_ROW(name, NAME, text, far, cone)           \
    EffectPart{.effect = Effect::name##_lights,           \
               .in_light = is_light_of<LightKind::name>,  \
               .strip = strip_lights_of<LightKind::name>, \
               .show = show_light<LightKind::name>},
    CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
        EffectPart{.effect = Effect::light_falloff,
                   .in_light = has_falloff,
                   .strip_light =
                       [](Light& light) {
                           light.range = 0.f, light.attenuation = {0.f, 0.f, 1.f};
                       },
                   .show =
                       [](Scene& s) {
                           make_light_with_range(s, {1.f, 0.2f, 0.f});
                       }},
    EffectPart{.effect = Effect::linear_ranges,
               .in_light = has_linear_range,
               .strip_light = [](Light& light) { light.linear_range = false; },
               .show =
                   [](Scene& s) {
                       make_light_with_range(s, {1.f, 0.f, 0.f}).linear_range = true;
                   }},
    EffectPart{.effect = Effect::light_lists, .find = find_light_lists, .show = show_rows_of_lights<4>},
    EffectPart{.effect = Effect::many_lights, .find = find_many_lights, .show = show_rows_of_lights<15>},
    EffectPart{.effect = Effect::hot_spots, .find = find_lights_of_hot_spots, .show = [](Scene& s) {
                   s.sky = {};
                   s.lights = {point_light({0.75f, 0.04f, 1.f}, {3.f, 2.5f, 2.f})};
               }}};

}  // namespace

std::span<const EffectPart> parts_of_lights() { return light_parts; }

}  // namespace claray
