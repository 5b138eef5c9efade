// The image round a scene as one of latitudes and longitudes, and the distribution by which its directions are sampled.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// As lights/environment.clh reads them.
struct EnvironmentImage {
    unsigned width = 0, height = 0;
    std::vector<float> texels;  // linear RGB, times the strength, row by row from +y down
    std::vector<float> cdf;     // of height + 1 rows of cells, then of the columns of each row
    float density = 0;          // EnvironmentData::density
    double integral = 0;        // of the luminance over all directions
};

/// A cube map becomes an image of latitudes and longitudes with the same resolution at the horizon. Throws
/// ErrorKind::user where there are neither 1 nor 6 images, or a texel is negative or not finite.
[[nodiscard]] EnvironmentImage environment_image(const Environment& environment);

}  // namespace claray
