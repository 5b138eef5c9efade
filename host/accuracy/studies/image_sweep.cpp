#include "host/accuracy/studies/image_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "host/compute/device_state.hpp"

namespace claray {
namespace {

/// Of one method and setting.
struct Runs {
    std::vector<ImageError> errors;
    std::vector<double> seconds;
};

StudyPoint point_of(const std::string& method, const Runs& runs, unsigned spp) {
    StudyPoint point;
    point.method = method, point.setting = std::to_string(spp) + " spp", point.value = spp;
    std::vector<double> rmse, relmse, perceptual;
    for (const ImageError& e : runs.errors) {
        rmse.push_back(e.rmse), relmse.push_back(e.relmse), perceptual.push_back(e.perceptual);
        if (!std::isfinite(e.rmse)) point.failure = "not finite";
    }
    point.runs = unsigned(rmse.size());
    point.seconds = spread_of(runs.seconds);
    if (rmse.empty()) point.failure = "was not run";
    if (!point.failure.empty()) return point;
    point.error = spread_of(rmse);
    point.errors = {point.error.median, spread_of(relmse).median, spread_of(perceptual).median};
    return point;
}

constexpr double least_cut_off_to_tell = 5e-4;

/// Images and reference end their paths at the same depth, so that their difference does not show the missing light.
void tell_cut_off(Study& study, const Device& device, const Scene& scene, RenderConfig config) {
    config.spp = 1;
    const double share = Renderer(device, scene, config).cut_off();
    if (share >= least_cut_off_to_tell)
        study.findings.push_back(
            printed("about %.2g %% of the light is missing in all images, since paths end after %u surfaces",
                    100 * share, config.max_depth));
}

}  // namespace

MacroScope::MacroScope(const Device& device, const std::vector<Macro>& macros)
    : device_(device), before_(device.state().tuning) {
    for (const Macro& macro : macros) device_.set_tuning(macro.kernel, macro.name, macro.value);
}
MacroScope::~MacroScope() { device_.state().tuning = before_; }

Rendered render_image(const Device& device, const Scene& scene, RenderConfig config) {
    config.seconds = config.noise = 0;
    Renderer renderer(device, scene, config);
    const RenderProgress reached = renderer.render();
    return {renderer.image(), reached.seconds};
}

RenderMethod render_with(const Device& device, const Scene& scene, std::vector<MacroScope::Macro> macros) {
    return [&scene, device, macros = std::move(macros)](const RenderConfig& config) {
        const MacroScope scope(device, macros);
        return render_image(device, scene, config);
    };
}

ReferenceImage reference_for(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
                             unsigned spp, const AccuracyProgress& progress) {
    const unsigned factor = options.reference_factor;
    ReferenceImage reference = reference_image(device, scene, options.config,
                                               {.least_spp = factor * spp,
                                                .render_spp = std::max(ReferenceOptions{}.render_spp, spp),
                                                .seed = options.reference_seed,
                                                .folder = options.references},
                                               scaled(progress, 0, reference_share));
    study.floor = reference.uncertainty, study.reference_spp = reference.spp;
    return reference;
}

void sweep_samples(Study& study, const StudyOptions& options, const std::vector<ImageMethod>& methods,
                   const ImageJudge& judge, const AccuracyProgress& progress) {
    std::vector<unsigned> spp;
    for (unsigned s = options.first_spp; s <= options.most_spp; s *= 2) spp.push_back(s);
    std::vector<std::vector<Runs>> runs(methods.size(), std::vector<Runs>(spp.size()));
    double samples = 0;
    const double all = double(options.runs) * double(methods.size()) * (2 * spp.back() - spp.front());
    bool goes_on = true;
    for (const ImageMethod& method : methods) {  // compiles its kernels
        RenderConfig config = options.config;
        config.spp = 1;
        (void)method.render(config);
    }
    for (unsigned round = 0; round < options.runs && goes_on; ++round)
        for (std::size_t i = 0; i < spp.size() && goes_on; ++i)
            for (std::size_t m = 0; m < methods.size() && goes_on; ++m) {
                RenderConfig config = options.config;
                config.spp = spp[i], config.seed = options.config.seed + round;
                const Rendered done = methods[m].render(config);
                runs[m][i].errors.push_back(judge(done.image, config));
                runs[m][i].seconds.push_back(done.seconds);
                samples += spp[i];
                goes_on = !progress || progress(samples / all, methods[m].name + ", run " + std::to_string(round + 1) +
                                                                   " of " + std::to_string(options.runs));
            }
    for (std::size_t m = 0; m < methods.size(); ++m)
        for (std::size_t i = 0; i < spp.size(); ++i)
            study.points.push_back(point_of(methods[m].name, runs[m][i], spp[i]));
    mark_front(study.points);
}

ReferenceImage sweep_to_reference(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
                                  const std::vector<ImageMethod>& methods, const AccuracyProgress& progress) {
    const ReferenceImage reference = reference_for(study, device, scene, options, options.most_spp, progress);
    sweep_samples(
        study, options, methods,
        [&](const std::vector<glm::vec3>& image, const RenderConfig& config) {
            return image_error(image, reference.pixels, config.width);
        },
        scaled(progress, reference_share, 1));
    tell_cut_off(study, device, scene, options.config);
    return reference;
}

}  // namespace claray
