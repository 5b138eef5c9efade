// What studies of images have in common: images by several methods and numbers of samples, in alternating runs.
#pragma once

#include <algorithm>

#include "host/accuracy/studies/kept_renderer.hpp"
#include "host/accuracy/study.hpp"

namespace claray {

/// A curve of a plot.
struct ImageMethod {
    std::string name;
    RenderMethod render;
};

using ImageJudge = std::function<ImageError(const std::vector<glm::vec3>&)>;

/// Call before the first timed image.
inline void begin_timing(const StudyOptions& options) {
    if (options.before_timing) options.before_timing();
}

/// Samples per pixel in studies without a sweep of samples.
[[nodiscard]] inline unsigned single_spp(const StudyOptions& options) {
    return options.single_spp == 0 ? options.most_spp : options.single_spp;
}

/// The largest number of samples per pixel in sweeps that compare other methods than samplers.
[[nodiscard]] inline unsigned compared_spp(const StudyOptions& options) {
    return options.compared_spp == 0 ? options.most_spp : std::min(options.compared_spp, options.most_spp);
}

[[nodiscard]] inline RenderConfig with_spp(const StudyOptions& options, unsigned spp) {
    RenderConfig config = options.config;
    config.spp = spp;
    return config;
}

/// `first_spp`, twice as many ... `most_spp` samples per pixel by each method, `runs` times with different seeds or
/// until a setting has taken `most_seconds`; adds the points to the study.
void sweep_samples(Study& study, const StudyOptions& options, unsigned most_spp,
                   const std::vector<ImageMethod>& methods, const ImageJudge& judge, const AccuracyProgress& progress);

/// Renders a reference with `reference_factor` times `spp` samples. Its error becomes the study's floor.
[[nodiscard]] ReferenceImage reference_for(Study& study, const Device& device, const Scene& scene,
                                           const StudyOptions& options, unsigned spp, const AccuracyProgress& progress);

/// Both: measures the errors against such a reference of `options.most_spp` samples, which all studies share.
ReferenceImage sweep_to_reference(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
                                  unsigned most_spp, const std::vector<ImageMethod>& methods,
                                  const AccuracyProgress& progress);

/// The part of such a study's progress that its reference takes.
constexpr double reference_share = 0.5;

}  // namespace claray
