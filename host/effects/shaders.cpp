// Which materials of a scene share a kernel that shades them.
#include <algorithm>

#include "claray/shared/path.h"
#include "host/effects/effects.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

/// Joins the two sets whose kernels gain the fewest effects.
void join_two(std::vector<EffectSet>& sets) {
    std::size_t least = number_of(known_effects());
    std::size_t first = 0, second = 1;
    for (std::size_t i = 0; i < sets.size(); ++i)
        for (std::size_t k = i + 1; k < sets.size(); ++k) {
            const std::size_t gained = number_of(sets[i] | sets[k]) - std::min(number_of(sets[i]), number_of(sets[k]));
            if (gained < least) least = gained, first = i, second = k;
        }
    sets[first] = sets[first] | sets[second];
    sets.erase(sets.begin() + std::ptrdiff_t(second));
}

}  // namespace

std::vector<EffectSet> shaders_of(const Scene& scene) {
    const std::vector<bool> used = used_materials(scene);
    std::vector<EffectSet> shaders;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const EffectSet own = effects_of_bsdf(scene.materials[i]);
        if (used[i] && std::find(shaders.begin(), shaders.end(), own) == shaders.end()) shaders.push_back(own);
    }
    while (shaders.size() > CLARAY_MOST_SHADERS) join_two(shaders);
    return shaders;
}

std::optional<std::uint32_t> shader_of(const Material& material, const std::vector<EffectSet>& shaders) {
    const EffectSet own = effects_of_bsdf(material);
    const auto found = std::find_if(shaders.begin(), shaders.end(), [&](EffectSet s) { return s.contains(own); });
    if (found == shaders.end()) return {};
    return std::uint32_t(found - shaders.begin());
}

}  // namespace claray
