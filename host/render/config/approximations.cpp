// The names of approximations.
#include <sstream>
#include <utility>

#include "claray/renderer.hpp"
#include "host/effects/effects.hpp"

namespace claray {
namespace {

constexpr std::pair<const char*, bool Approximations::*> approximation_names[] = {
    {"tile-sum", &Approximations::tile_sum},
    {"light-grid", &Approximations::light_grid},
    {"flat", &Approximations::flat},
    {"gouraud", &Approximations::gouraud},
    {"no-shadows", &Approximations::no_shadows}};

}  // namespace

Approximations all_approximations() {
    Approximations all;
    for (const auto& [name, member] : approximation_names) all.*member = true;
    return all;
}

std::string to_string(const Approximations& approximations) {
    std::string text;
    for (const auto& [name, member] : approximation_names)
        if (approximations.*member) text += (text.empty() ? "" : ",") + std::string(name);
    return text.empty() ? "nothing" : text;
}

std::vector<Approximations> approximations_for(const Scene& scene, const Approximations& among) {
    const EffectSet effects = effects_of(scene);
    Approximations useful = {.flat = true, .gouraud = true};
    useful.tile_sum = !scene.lights.empty();
    useful.light_grid = !(effects & EffectSet{Effect::lambert, Effect::oren_nayar}).empty();
    useful.no_shadows = !(effects & effects_with(CLARAY_SAMPLED)).empty();
    std::vector<Approximations> found;
    for (const auto& [name, member] : approximation_names) {
        if (!(among.*member && useful.*member)) continue;
        found.emplace_back().*member = true;
    }
    return found;
}

std::string to_string(const LightGridConfig& grid) {
    std::string text;
    for (const unsigned value :
         {unsigned(grid.voxels), grid.side, grid.coefficients, grid.levels, grid.gather, grid.rays, grid.updates})
        text += (text.empty() ? "" : " ") + std::to_string(value);
    return text;
}

Approximations parse_approximations(const std::string& text) {
    Approximations found;
    if (text == "nothing") return found;
    std::istringstream items(text + ',');
    for (std::string item; std::getline(items, item, ',');) {
        bool known = false;
        for (const auto& [name, member] : approximation_names)
            if (item == name) found.*member = known = true;
        if (known) continue;
        throw Error(ErrorKind::usage, "there is no approximation '" + item + "'",
                    "there are: " + to_string(all_approximations()));
    }
    return found;
}

}  // namespace claray
