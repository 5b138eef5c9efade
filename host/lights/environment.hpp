// The latitude-longitude image around a scene, and the distribution for sampling its directions.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// In the layout of lights/environment.clh.
struct EnvironmentImage {
    unsigned width = 0, height = 0;
    std::vector<float> texels;  // linear RGB, times the strength, row by row from +y down
    std::vector<float> cdf;     // of height + 1 rows of cells, then of the columns of each row, with starts
    float density = 0;          // EnvironmentData::density
    float baseline = 0;         // EnvironmentData::baseline
    double integral = 0;        // of the luminance over all directions
};

/// Converts a cube map to a latitude-longitude image with the same resolution at the horizon. Throws ErrorKind::user if
/// there are neither 1 nor 6 images, or if a texel is negative or not finite. `compensates`: directions that are darker
/// than the mean are mostly left to BSDF sampling.
[[nodiscard]] EnvironmentImage environment_image(const Environment& environment, bool compensates = true);

}  // namespace claray
