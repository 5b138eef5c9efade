// Which macros of which kernels belong to an effect. A BSDF is an effect by its row in claray/shared/lists/bsdfs.h, a
// kind of light by its row in lights.h. Any other new effect is a row of effects.h, who calls for it and how a scene is
// stripped of it in effects_of.cpp, a scene in tests/render/effects_test.cpp, and in the kernels conditions with
// its macro. Its code must find nothing to do in scenes without the effect (an absent buffer is null, a count is 0):
// kernels may know more than the scene needs.
#pragma once

#include <optional>

#include "claray/effects.hpp"
#include "claray/program.hpp"

namespace claray {

/// Kernels that are compiled for a set of effects.
enum class Stage : unsigned {
    generate = 1,  // render/generate_rays.cl
    trace = 2,     // trace/closest_hit.cl, trace/any_hit.cl
    shade = 4,     // render/shade_surface.cl
    aovs = 8       // render/write_aovs.cl
};

[[nodiscard]] std::size_t number_of(EffectSet effects);
/// All macros of a stage; 0 if the effect is not in the set.
[[nodiscard]] Defines defines_of(EffectSet effects, Stage stage);
/// The effect of a material's kind, without its other effects.
[[nodiscard]] Effect effect_of(MaterialKind kind);
/// The effects for which that stage's kernels contain code.
[[nodiscard]] EffectSet of_stage(EffectSet effects, Stage stage);
/// Whether code that works on sixteen rays at once (CLARAY_LANES_... of claray/shared/lists/effects.h) may run in
/// scenes with all of these effects.
[[nodiscard]] bool have_lanes(EffectSet effects, unsigned lanes);
/// Whether that stage's kernels contain code for the effect.
[[nodiscard]] bool concerns(Effect effect, Stage stage);

/// The effects of a material's BSDF.
[[nodiscard]] EffectSet effects_of_bsdf(const Material& material);
/// The sets of these effects that the scene's materials have: the shaders, each for a kernel of its own. At most
/// CLARAY_MOST_SHADERS; the most similar ones are joined.
[[nodiscard]] std::vector<EffectSet> shaders_of(const Scene& scene);
/// The number of the first shader with all effects of the material's BSDF, or nothing.
[[nodiscard]] std::optional<std::uint32_t> shader_of(const Material& material, const std::vector<EffectSet>& shaders);

/// Effects that only the BSDFs of single materials need.
inline constexpr EffectSet bsdf_effects = {Effect::transmission,    Effect::rough_glass, Effect::clearcoat,
                                           Effect::layered_coat,    Effect::specular,    Effect::iridescence,
                                           Effect::anisotropy,      Effect::sheen,
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) Effect::name,
                                           CLARAY_BSDFS(CLARAY_ROW)
#undef CLARAY_ROW
};
/// Effects that need shadow rays.
inline constexpr EffectSet sampled_lights = {
#define CLARAY_ROW(name, NAME, text, far, cone) Effect::name##_lights,
    CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
        Effect::emissive_triangles,
    Effect::environment};
/// Effects that give radiance to the end of a path.
inline constexpr EffectSet emitters = {
#define CLARAY_ROW(name, NAME, text, far, cone) Effect::name##_lights,
    CLARAY_SEEN_LIGHTS(CLARAY_ROW)
#undef CLARAY_ROW
        Effect::emissive_triangles,
    Effect::sky, Effect::environment, Effect::light_maps, Effect::unlit};
/// Effects that change the noise of an image but not its limit. Removing one changes no part of the scene.
inline constexpr EffectSet aids = {Effect::light_lists, Effect::many_lights, Effect::hot_spots};

}  // namespace claray
