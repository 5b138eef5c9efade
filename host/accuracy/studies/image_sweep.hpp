// Images by several methods and numbers of samples, by turns: what studies of images have in common.
#pragma once

#include <map>

#include "host/accuracy/study.hpp"

namespace claray {

struct Rendered {
    std::vector<glm::vec3> image;
    double seconds = 0;  ///< of the samples alone
};
/// With all samples of `config.spp`.
[[nodiscard]] Rendered render_image(const Device& device, const Scene& scene, RenderConfig config);

/// A curve of a plot: how an image is made from a configuration.
struct ImageMethod {
    std::string name;
    std::function<Rendered(const RenderConfig&)> render;
};

/// How wrong an image is that was made with a configuration.
using ImageJudge = std::function<ImageError(const std::vector<glm::vec3>&, const RenderConfig&)>;

/// 1, 2, 4 ... samples a pixel by each method, `runs` times with seeds of their own; adds the points to the study.
void sweep_samples(Study& study, const StudyOptions& options, const std::vector<ImageMethod>& methods,
                   const ImageJudge& judge, const AccuracyProgress& progress);

/// A reference with 64 times the samples of the largest setting, whose error becomes the study's floor.
[[nodiscard]] ReferenceImage reference_for(Study& study, const Device& device, const Scene& scene,
                                           const StudyOptions& options, const AccuracyProgress& progress);

/// Both: the errors against such a reference.
ReferenceImage sweep_to_reference(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
                                  const std::vector<ImageMethod>& methods, const AccuracyProgress& progress);

/// The part of such a study that its reference takes, of what progress shows.
constexpr double reference_share = 0.5;

/// Kernels are compiled with other values of macros until the end of the scope.
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

}  // namespace claray
