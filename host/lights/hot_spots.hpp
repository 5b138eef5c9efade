// Point lights so close to surfaces that paths should sample the bright spots: lights/light_hot_spot.clh.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

struct HotSpotPlace {
    std::size_t light = 0;   // of the scene's lights
    glm::vec3 way{0.f};      // from the light to the nearest surface
    double probability = 0;  // of aiming a scattered ray at it
};

/// In the order of the lights; empty if no light is close enough to a surface. Lights without inverse-square
/// attenuation are ignored, because their irradiance is bounded.
[[nodiscard]] std::vector<HotSpotPlace> find_hot_spots(const Scene& scene);

}  // namespace claray
