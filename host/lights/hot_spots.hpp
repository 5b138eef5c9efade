// Point lights so close to surfaces that paths should sample the bright spots: lights/light_hot_spot.clh.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

struct HotSpotPlace {
    std::size_t light = 0;   // of the scene's lights
    glm::vec3 way{0.f};      // from there to the nearest surface
    double probability = 0;  // with which a scattered ray goes there
};

/// In the order of the lights. Empty where no light is close enough. Lights that fall off otherwise than by the inverse
/// square do not get bright without bounds, and do not count.
[[nodiscard]] std::vector<HotSpotPlace> find_hot_spots(const Scene& scene);

}  // namespace claray
