// The difference between two images.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// The difference between two images of linear radiance. All members are without unit.
struct ImageError {
    double rmse = 0;    ///< square root of the mean squared difference of all channels, divided by the reference's mean
    double relmse = 0;  ///< mean over channels of (difference / (reference + 1 % of its mean))^2
    double perceptual = 0;  ///< 0 to 1: the colour term of FLIP (Andersson et al. 2020), equal exposure of both images
};

/// Compares two images, stored as rows of `width` pixels. Throws ErrorKind::usage if the sizes differ or the images are
/// empty.
[[nodiscard]] ImageError image_error(std::span<const glm::vec3> image, std::span<const glm::vec3> reference,
                                     unsigned width);

}  // namespace claray
#pragma GCC visibility pop
