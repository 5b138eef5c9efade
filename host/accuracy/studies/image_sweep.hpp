// What studies of images have in common: images by several methods and numbers of samples, in alternating runs.
#pragma once

#include <algorithm>
#include <map>
#include <optional>

#include "host/accuracy/study.hpp"

namespace claray {

struct Rendered {
    std::vector<glm::vec3> image;
    double seconds = 0;  ///< of sampling only
};

/// Compiles kernels with other values of macros until the end of the scope.
class MacroScope {
public:
    struct Macro {
        const char* kernel;
        const char* name;
        unsigned value;
    };
    MacroScope(const Device& device, const std::vector<Macro>& macros);
    ~MacroScope();
    MacroScope(const MacroScope&) = delete;
    MacroScope& operator=(const MacroScope&) = delete;

private:
    Device device_;
    std::map<std::string, unsigned> before_;  // Device::State::tuning
};

/// Renders with the settings of `config`, up to its number of samples, by kernels with these values of macros. The
/// first render makes a renderer and loads its kernels. The scene must outlive it.
class KeptRenderer {
public:
    KeptRenderer(const Device& device, const Scene& scene, const RenderConfig& config,
                 std::vector<MacroScope::Macro> macros = {});
    /// `max_depth`: 0 for that of the configuration, which is the largest.
    [[nodiscard]] Rendered render(std::uint32_t seed, unsigned spp, unsigned max_depth = 0);

private:
    Device device_;
    const Scene& scene_;
    RenderConfig config_;
    std::vector<MacroScope::Macro> macros_;
    std::optional<Renderer> renderer_;
};

/// Renders with this seed and so many samples per pixel.
using RenderMethod = std::function<Rendered(std::uint32_t seed, unsigned spp)>;
/// By a renderer that is kept until the last copy of the method is gone.
[[nodiscard]] RenderMethod render_with(const Device& device, const Scene& scene, const RenderConfig& config,
                                       std::vector<MacroScope::Macro> macros = {});
/// One image with all samples of `config.spp`.
[[nodiscard]] Rendered render_image(const Device& device, const Scene& scene, const RenderConfig& config);

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
