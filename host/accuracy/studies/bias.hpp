// The error of an image that more samples do not reduce.
#pragma once

#include "host/accuracy/studies/image_sweep.hpp"

namespace claray {

/// Independent renders of one setting.
struct Renders {
    std::vector<std::vector<glm::vec3>> images;
    std::vector<double> seconds;
};
/// Renders 2 `runs` images of `spp` samples per pixel, fewer if they take `most_seconds`, at least 4. Their seeds
/// follow that of the configuration.
[[nodiscard]] Renders render_independently(const RenderMethod& method, unsigned spp, const StudyOptions& options);

/// A point whose error is the renders' bias against the reference; it fails if the bias is not above the noise.
[[nodiscard]] StudyPoint bias_point(const std::string& method, const std::string& setting, double value,
                                    const Renders& renders, const ReferenceImage& reference);

/// The same of each pixel, over the reference's mean: the root of the mean of (a - r)(b - r) over all pairs and
/// channels, 0 if noise makes that negative.
[[nodiscard]] std::vector<float> bias_map(const Renders& renders, const ReferenceImage& reference);

}  // namespace claray
