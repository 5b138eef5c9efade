// Effects of a scene. Kernels contain code only for the effects that the scene uses. Data and commands that no effect
// needs are neither uploaded nor run.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// Each effect is a part of the kernel code that a scene may not need. The rows of three lists are effects, too: BSDFs
/// (claray/shared/lists/bsdfs.h), kinds of lights (lights.h), and projections but perspective (projections.h).
enum class Effect : std::uint8_t {
    smooth_normals,
    transmission,
    rough_glass,
    clearcoat,
    absorption,
    culling,
    emissive_triangles,
    light_falloff,
    linear_ranges,
    light_lists,
    many_lights,
    sky,
    environment,
    textures,
    mip_maps,
    nearest_levels,
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
    primitives,
    nested_media,
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) name,
    CLARAY_BSDFS(CLARAY_ROW)
#undef CLARAY_ROW
#define CLARAY_ROW(name, NAME, text, far, cone) name##_lights,
        CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) name,
            CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// A set of effects.
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

/// Returns the name for users: "smooth-normals".
[[nodiscard]] const char* name_of(Effect effect);
/// Returns all effects that the kernels support, in display order.
[[nodiscard]] std::span<const Effect> all_effects();
/// Returns the same effects as a set.
[[nodiscard]] EffectSet known_effects();
/// Returns the effects of the generic kernels: all except instances and primitives, which have
/// kernels of their own.
[[nodiscard]] EffectSet full_effects();
/// Returns the names, separated by commas: "lambert, point-lights". Returns "nothing" for an empty set.
[[nodiscard]] std::string to_string(EffectSet effects);

/// Parses the output of `to_string`, with or without blanks. Throws ErrorKind::usage for an unknown name.
[[nodiscard]] EffectSet parse_effects(const std::string& text);

/// Returns the effects that the scene uses.
[[nodiscard]] EffectSet effects_of(const Scene& scene);

/// Why a scene uses an effect.
struct EffectCause {
    Effect effect{};
    std::string first;      ///< the first object that uses it: "the material 'gold'"
    std::size_t count = 0;  ///< number of objects that use it
};
/// Returns one row for every effect of `effects_of`, in the order of `all_effects`.
[[nodiscard]] std::vector<EffectCause> causes_of_effects(const Scene& scene);

/// For experiments. `add`: effects compiled in although the scene does not use them; no pixel changes. `remove`:
/// effects removed from the scene; the image changes.
struct EffectOverrides {
    EffectSet add = {}, remove = {};
    [[nodiscard]] bool any() const { return !add.empty() || !remove.empty(); }
};
/// Parses a list such as "+textures,-sky". Throws ErrorKind::usage if the list is malformed or a name is unknown.
[[nodiscard]] EffectOverrides parse_effect_overrides(const std::string& text);
/// Returns the scene without some effects, by the rules of `effects_of`: for example without normals or without lights
/// of a kind. A material of a removed kind becomes Lambert, a lens becomes a pinhole.
[[nodiscard]] Scene without_effects(Scene scene, EffectSet effects);

}  // namespace claray
