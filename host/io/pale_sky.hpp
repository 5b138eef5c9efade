// Light for scenes that bring none.
#pragma once

#include <algorithm>

#include "claray/io.hpp"

namespace claray {

inline constexpr const char* pale_sky_warning = "no material emits light: a pale sky lights the scene";

/// Lights a scene in which nothing shines by a pale sky, with a warning.
inline void light_by_pale_sky(Scene& scene, Warnings& warnings) {
    const bool emits = std::any_of(scene.materials.begin(), scene.materials.end(),
                                   [](const Material& m) { return m.emission != glm::vec3(0.f); });
    if (emits || !scene.lights.empty()) return;
    scene.sky = {{0.2f, 0.23f, 0.28f}, {1.1f, 1.15f, 1.25f}};  // dark behind what is lit from above
    warnings.emplace_back(pale_sky_warning);
}

}  // namespace claray
