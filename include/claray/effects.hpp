// What a scene calls for: kernels hold the code of these effects and of no other, and what none of them needs is
// neither uploaded nor run.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// Each is a piece of kernel code that a scene can do without. Every BSDF is one: Effect::lambert, mirror, glass,
/// metal, blinn_phong, principled, unlit, thin_walls and coated_metal.
/// So is every kind of light: Effect::point_lights, directional_lights and spot_lights.
enum class Effect : std::uint8_t {
    smooth_normals,
    transmission,
    rough_glass,
    clearcoat,
    absorption,
    culling,
    emissive_triangles,
    light_falloff,
    many_lights,
    sky,
    environment,
    textures,
    mip_maps,
    normal_maps,
    height_maps,
    light_maps,
    cut_outs,
    depth_of_field,
    camera_motion,
    instances,
    instance_motion,
    emission_maps,
    hot_spots,
    vertex_colors,
    specular,
    sheen,
    anisotropy,
    iridescence,
    layered_coat,
    orthographic,
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) name,
    CLARAY_BSDFS(CLARAY_ROW)
#undef CLARAY_ROW
#define CLARAY_ROW(name, NAME, text, far, cone) name##_lights,
        CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
};

class EffectSet {
public:
    constexpr EffectSet() = default;
    constexpr EffectSet(std::initializer_list<Effect> effects) {
        for (const Effect effect : effects) add(effect);
    }
    constexpr void add(Effect effect) { bits_ |= bit(effect); }
    constexpr void remove(Effect effect) { bits_ &= ~bit(effect); }
    [[nodiscard]] constexpr bool has(Effect effect) const { return (bits_ & bit(effect)) != 0; }
    [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
    [[nodiscard]] constexpr bool contains(EffectSet other) const { return (other.bits_ & ~bits_) == 0; }
    [[nodiscard]] constexpr EffectSet operator|(EffectSet other) const { return EffectSet(bits_ | other.bits_); }
    [[nodiscard]] constexpr EffectSet operator-(EffectSet other) const { return EffectSet(bits_ & ~other.bits_); }
    [[nodiscard]] constexpr EffectSet operator&(EffectSet other) const { return EffectSet(bits_ & other.bits_); }
    constexpr bool operator==(const EffectSet&) const = default;

private:
    explicit constexpr EffectSet(std::uint64_t bits) : bits_(bits) {}
    static constexpr std::uint64_t bit(Effect effect) { return std::uint64_t(1) << unsigned(effect); }
    std::uint64_t bits_ = 0;
};

/// As users write it: "smooth-normals".
[[nodiscard]] const char* name_of(Effect effect);
/// Every effect that the kernels know, in the order in which they are shown.
[[nodiscard]] std::span<const Effect> all_effects();
/// The same as a set.
[[nodiscard]] EffectSet known_effects();
/// What the generic kernels can do: all but instances, which have kernels of their own.
[[nodiscard]] EffectSet full_effects();
/// "lambert, point-lights"; "nothing" where the set is empty.
[[nodiscard]] std::string to_string(EffectSet effects);

/// The reverse, with or without blanks. Throws ErrorKind::usage for a name that is none.
[[nodiscard]] EffectSet parse_effects(const std::string& text);

/// What the scene calls for.
[[nodiscard]] EffectSet effects_of(const Scene& scene);

struct EffectCause {
    Effect effect{};
    std::string first;      ///< who calls for it: "the material 'gold'"
    std::size_t count = 0;  ///< how many do
};
/// Why: one row for every effect of `effects_of`, in the order of `all_effects`.
[[nodiscard]] std::vector<EffectCause> causes_of_effects(const Scene& scene);

/// For experiments: effects that are compiled in though nothing calls for them, which changes no pixel, and effects
/// that the scene is stripped of, which changes the image.
struct EffectOverrides {
    EffectSet add, remove;
    [[nodiscard]] bool any() const { return !add.empty() || !remove.empty(); }
};
/// "+textures,-sky". Throws ErrorKind::usage for what is no such list.
[[nodiscard]] EffectOverrides parse_effect_overrides(const std::string& text);
/// The scene stripped of some effects, by the same rules as `effects_of`: no normals, no lights of a kind, a material
/// of that kind is Lambert, a lens is a pinhole, and so on.
[[nodiscard]] Scene without_effects(Scene scene, EffectSet effects);
/// A square with lights and a camera that calls for the effects, and for `lambert`, as simply as can be.
[[nodiscard]] Scene scene_calling_for(EffectSet effects);

}  // namespace claray
