// Which macros of which kernels belong to an effect. A BSDF is an effect by its row in claray/shared/lists/bsdfs.h, a
// kind of light by its row in lights.h. Any other new effect is a row of effects.h, an entry in a file of
// host/effects/parts, and in the kernels conditions with its macro. Its code must find nothing to do in scenes without
// the effect (an absent buffer is null, a count is 0): kernels may know more than the scene needs.
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
/// The effects for which that stage's kernels contain code.
[[nodiscard]] EffectSet of_stage(EffectSet effects, Stage stage);
/// Whether code that works on sixteen rays at once (CLARAY_LANES_... of claray/shared/lists/effects.h) may run in
/// scenes with all of these effects.
[[nodiscard]] bool have_lanes(EffectSet effects, unsigned lanes);
/// The effects with one of these traits: CLARAY_OF_BSDF and others of claray/shared/lists/effects.h.
[[nodiscard]] EffectSet effects_with(unsigned traits);
/// Whether that stage's kernels contain code for the effect.
[[nodiscard]] bool concerns(Effect effect, Stage stage);

/// The scene as rays need it for its effects; nothing if it is so already.
[[nodiscard]] std::optional<Scene> prepared_for_effects(const Scene& scene);

/// The effects of a material's BSDF.
[[nodiscard]] EffectSet effects_of_bsdf(const Material& material);
/// The sets of these effects that the scene's materials have: the shaders, each for a kernel of its own. At most
/// CLARAY_MOST_SHADERS; the most similar ones are joined.
[[nodiscard]] std::vector<EffectSet> shaders_of(const Scene& scene);
/// The number of the first shader with all effects of the material's BSDF, or nothing.
[[nodiscard]] std::optional<std::uint32_t> shader_of(const Material& material, const std::vector<EffectSet>& shaders);

}  // namespace claray
