// All of an effect but its kernels' code: what of a scene needs it, the scene without it, and a scene that shows it.
// Each file of this folder has the effects of one part of scenes.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "claray/effects.hpp"
#include "claray/shared/path.h"
#include "host/scene/builtin/effects_stage.hpp"

namespace claray {

/// A scene in which effects are looked for.
struct SearchedScene {
    const Scene& scene;
    std::vector<bool> used;  ///< for every material, whether a triangle or a primitive has it
};
/// Told of an object that needs the effect: its kind, such as "material", its name, and its index.
using Found = std::function<void(const char*, const std::string&, std::size_t)>;

/// Tables for the kernels: their members of SceneTables, and their words.
using EffectTables = std::vector<std::pair<std::uint32_t SceneTables::*, std::vector<std::uint32_t>>>;

/// Functions may be null.
struct EffectPart {
    Effect effect{};
    bool (*in_material)(const Material&) = nullptr;              ///< whether a material that is used needs the effect
    bool (*in_light)(const Light&) = nullptr;                    ///< whether a light that is not black needs it
    bool (*in_camera)(const Camera&) = nullptr;                  ///< whether the camera needs it
    void (*find)(const SearchedScene&, const Found&) = nullptr;  ///< finds all else that needs it
    void (*strip_material)(Material&) = nullptr;                 ///< of those that need it; all, without `in_material`
    void (*strip_light)(Light&) = nullptr;                       ///< of all lights
    void (*strip_camera)(Camera&) = nullptr;                     ///< of those that need it
    void (*strip)(Scene&) = nullptr;                             ///< takes it from all else
    std::optional<Scene> (*prepare)(const Scene&) = nullptr;     ///< the scene as rays need it; nothing if it is so
    EffectTables (*tables)(const Scene&) = nullptr;              ///< empty ones if the scene has no such effect
    /// Changes a stage (effects_stage.hpp) under a sky. The scene then has the effect, Lambert, one kind of light, and
    /// what the effect cannot be had without.
    void (*show)(Scene&) = nullptr;
    bool apart = false;  ///< not in the scene `effects`, since it replaces others or starts slowly
};

[[nodiscard]] std::span<const EffectPart> parts_of_kinds();
[[nodiscard]] std::span<const EffectPart> parts_of_layers();
[[nodiscard]] std::span<const EffectPart> parts_of_media();
[[nodiscard]] std::span<const EffectPart> parts_of_textures();
[[nodiscard]] std::span<const EffectPart> parts_of_lights();
[[nodiscard]] std::span<const EffectPart> parts_of_sky();
[[nodiscard]] std::span<const EffectPart> parts_of_cameras();
[[nodiscard]] std::span<const EffectPart> parts_of_shapes();
[[nodiscard]] const EffectPart& part_of(Effect effect);
[[nodiscard]] EffectSet effects_in(std::span<const EffectPart> parts);

/// Whether a light or a surface gives off any light.
[[nodiscard]] inline bool is_lit(const glm::vec3& c) { return c.x > 0 || c.y > 0 || c.z > 0; }

/// Calls `visit(material, index)` for the materials that are used.
template <class Visit>
void for_each_material(const SearchedScene& searched, const Visit& visit) {
    for (std::size_t i = 0; i < searched.scene.materials.size(); ++i)
        if (searched.used[i]) visit(searched.scene.materials[i], i);
}

// What several parts of the stage's scenes have.

[[nodiscard]] Material& ball_of(Scene& stage);
void set_kind(Scene& stage, MaterialKind kind, const glm::vec3& albedo, float roughness);
void make_principled(Scene& stage);
void make_glass(Scene& stage);
Light& replace_sky_by(Scene& stage, LightKind kind);
/// With a sun that coats reflect.
void replace_sky_by_evening(Scene& stage);

}  // namespace claray
