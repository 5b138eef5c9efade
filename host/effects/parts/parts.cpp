#include <array>
#include <stdexcept>

#include "claray/error.hpp"
#include "host/effects/effects.hpp"
#include "host/effects/parts/part.hpp"
#include "host/scene/builtin/builtin.hpp"

namespace claray {
namespace {

constexpr std::array all_parts = {parts_of_kinds,  parts_of_layers, parts_of_media,   parts_of_textures,
                                  parts_of_lights, parts_of_sky,    parts_of_cameras, parts_of_shapes};

const EffectPart* find_part(Effect effect) {
    for (const auto& parts : all_parts)
        for (const EffectPart& part : parts())
            if (part.effect == effect) return &part;
    return nullptr;
}

}  // namespace

const EffectPart& part_of(Effect effect) {
    if (const EffectPart* part = find_part(effect)) return *part;
    throw std::logic_error(std::string("no file of host/effects/parts has the effect ") + name_of(effect));
}

EffectSet effects_in(std::span<const EffectPart> parts) {
    EffectSet effects;
    for (const EffectPart& part : parts) effects.add(part.effect);
    return effects;
}

Material& ball_of(Scene& stage) { return stage.materials[scenes::ball_material]; }

void set_kind(Scene& stage, MaterialKind kind, const glm::vec3& albedo, float roughness) {
    ball_of(stage).kind = kind, ball_of(stage).albedo = albedo, ball_of(stage).roughness = roughness;
}

void make_principled(Scene& stage) { set_kind(stage, MaterialKind::principled, {0.7f, 0.25f, 0.12f}, 0.35f); }

void make_glass(Scene& stage) { set_kind(stage, MaterialKind::glass, glm::vec3(0.98f), 0.f); }

Light& replace_sky_by(Scene& stage, LightKind kind) {
    stage.sky = {};
    Light light = point_light({-1.8f, 3.f, 2.2f}, glm::vec3(24.f, 22.f, 19.f));
    light.kind = kind;
    stage.lights = {light};
    return stage.lights[0];
}

void replace_sky_by_evening(Scene& stage) {
    stage.sky = {}, stage.environment.images = {scenes::evening_environment()};
}

Scene scenes::effect_alone(const std::string& name) {
    std::string known;
    for (const Effect effect : all_effects()) {
        known += (known.empty() ? "" : ", ") + std::string(name_of(effect));
        if (name != name_of(effect)) continue;
        Scene scene = empty_stage();
        scene.sky = {{0.95f, 0.93f, 0.9f}, {0.35f, 0.5f, 0.8f}};
        part_of(effect).show(scene);
        return scene;
    }
    throw Error(ErrorKind::usage, "scene 'effect:NAME': NAME is '" + name + "'", "give one of: " + known);
}

}  // namespace claray
