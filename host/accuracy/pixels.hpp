// What measures and studies ask of an image.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace claray {

/// Of all channels of all pixels.
[[nodiscard]] inline double mean_of(std::span<const glm::vec3> image) {
    double sum = 0;
    for (const glm::vec3& p : image) sum += double(p.x) + double(p.y) + double(p.z);
    return sum / (3.0 * double(image.size()));
}

}  // namespace claray
