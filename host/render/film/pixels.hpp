// Functions on pixels that measures and studies share.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "host/base/in_parallel.hpp"

namespace claray {

/// Of all channels of all pixels.
[[nodiscard]] inline double mean_of(std::span<const glm::vec3> image) {
    double sum = 0;
    for (const glm::vec3& p : image) sum += double(p.x) + double(p.y) + double(p.z);
    return sum / (3.0 * double(image.size()));
}

/// An image of fewer pixels at the size of `width` x `height`, bilinear between the pixels' centres.
[[nodiscard]] inline std::vector<glm::vec3> enlarged(const std::vector<glm::vec3>& image, unsigned from_width,
                                                     unsigned from_height, unsigned width, unsigned height) {
    std::vector<glm::vec3> large(std::size_t(width) * height);
    const auto at = [&](int x, int y) {
        x = std::clamp(x, 0, int(from_width) - 1), y = std::clamp(y, 0, int(from_height) - 1);
        return image[std::size_t(y) * from_width + std::size_t(x)];
    };
    in_parallel(height, [&](std::size_t y) {
        for (unsigned x = 0; x < width; ++x) {
            const float fx = (float(x) + 0.5f) * float(from_width) / float(width) - 0.5f;
            const float fy = (float(y) + 0.5f) * float(from_height) / float(height) - 0.5f;
            const int x0 = int(std::floor(fx)), y0 = int(std::floor(fy));
            large[y * width + x] =
                glm::mix(glm::mix(at(x0, y0), at(x0 + 1, y0), fx - float(x0)),
                         glm::mix(at(x0, y0 + 1), at(x0 + 1, y0 + 1), fx - float(x0)), fy - float(y0));
        }
    });
    return large;
}

}  // namespace claray
