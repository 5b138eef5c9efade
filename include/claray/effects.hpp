// Effects of a scene. Kernels contain code only for the effects that the scene uses. Data and commands that no effect
// needs are neither uploaded nor run.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "claray/scene.hpp"
#include "claray/shared/lists/effects.h"

#pragma GCC visibility push(default)
namespace claray {

/// Each effect is a part of the kernel code that a scene may not need. claray/shared/lists/effects.h lists them. Every
/// BSDF is an effect, such as Effect::glass; so is every kind of light, such as Effect::point_lights, and every camera
/// that is not perspective, such as Effect::orthographic.
enum class Effect : std::uint8_t {
#define CLARAY_ROW(name, ...) name,
#define CLARAY_LIGHT(name, ...) name##_lights,
    CLARAY_EFFECTS(CLARAY_ROW, CLARAY_ROW, CLARAY_LIGHT, CLARAY_ROW)
#undef CLARAY_ROW
#undef CLARAY_LIGHT
};

/// A set of effects.
class EffectSet {
public:
    static constexpr unsigned most = 128;  ///< numbers of effects are below

    constexpr EffectSet() = default;
    constexpr EffectSet(std::initializer_list<Effect> effects) {
        for (const Effect effect : effects) add(effect);
    }
    constexpr void add(Effect effect) { word_of(effect) |= bit(effect); }
    constexpr void remove(Effect effect) { word_of(effect) &= ~bit(effect); }
    [[nodiscard]] constexpr bool has(Effect effect) const { return (words_[unsigned(effect) / 64] & bit(effect)) != 0; }
    [[nodiscard]] constexpr bool empty() const { return *this == EffectSet(); }
    [[nodiscard]] constexpr bool contains(EffectSet other) const { return (other - *this).empty(); }
    [[nodiscard]] constexpr EffectSet operator|(EffectSet other) const {
        return EffectSet(words_[0] | other.words_[0], words_[1] | other.words_[1]);
    }
    [[nodiscard]] constexpr EffectSet operator-(EffectSet other) const {
        return EffectSet(words_[0] & ~other.words_[0], words_[1] & ~other.words_[1]);
    }
    [[nodiscard]] constexpr EffectSet operator&(EffectSet other) const {
        return EffectSet(words_[0] & other.words_[0], words_[1] & other.words_[1]);
    }
    constexpr bool operator==(const EffectSet&) const = default;

private:
    constexpr EffectSet(std::uint64_t low, std::uint64_t high) : words_{low, high} {}
    static constexpr std::uint64_t bit(Effect effect) { return std::uint64_t(1) << unsigned(effect) % 64; }
    constexpr std::uint64_t& word_of(Effect effect) { return words_[unsigned(effect) / 64]; }
    std::array<std::uint64_t, most / 64> words_{};
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
#pragma GCC visibility pop
