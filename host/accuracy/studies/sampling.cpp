// Studies of samples: how fast noise falls, by sampler and by what is sampled.
#include <cmath>

#include "host/accuracy/studies/bias.hpp"
#include "host/accuracy/studies/image_sweep.hpp"

namespace claray {
namespace {

/// How fast the error falls with the samples. Where it stops falling, new renders tell whether that is bias, or rare
/// bright samples that few images have met.
void judge_sampling(Study& study, const ImageMethod& with, const StudyOptions& options,
                    const ReferenceImage& reference) {
    const std::string& method = with.name;
    std::vector<double> samples, errors;
    for (const StudyPoint& p : study.points) {
        if (p.method != method || !p.failure.empty() || p.value < 2) continue;
        samples.push_back(p.value), errors.push_back(p.error.median);
    }
    if (samples.size() < 3) return;
    study.findings.push_back(method + printed(": the error is proportional to the samples to the power of %.3f",
                                              log_log_slope(samples, errors)));
    const std::size_t tail = samples.size() - 3;
    const double end = log_log_slope(std::span(samples).subspan(tail), std::span(errors).subspan(tail));
    if (end <= -0.25) return;
    RenderConfig config = options.config;
    config.spp = options.most_spp;
    const StudyPoint bias =
        bias_point(method, "", 0, render_independently(with.render, config, options.runs), reference);
    study.findings.push_back(
        method +
        (bias.failure.empty()
             ? printed(": stops decreasing at %.3g %%: %.3g %% of this is bias, or light that no render has found",
                       100 * errors.back(), 100 * bias.error.median)
             : printed(": decreases slowly at %.3g %%, due to rare bright samples; %s", 100 * errors.back(),
                       bias.failure.c_str())));
}

/// error^2 * seconds: what an error costs, whatever it is.
double cost_of(double error, double seconds) { return error * error * seconds; }

/// Of its most samples.
Spread cost_of(const Study& study, const std::string& method) {
    Spread last;
    for (const StudyPoint& p : study.points)
        if (p.method == method && p.failure.empty())
            last = {cost_of(p.error.low, p.seconds.low), cost_of(p.error.median, p.seconds.median),
                    cost_of(p.error.high, p.seconds.high)};
    return last;
}

void compare_efficiency(Study& study, const std::vector<ImageMethod>& methods) {
    const Spread first = cost_of(study, methods.front().name);
    for (std::size_t i = 1; i < methods.size(); ++i) {
        const Spread other = cost_of(study, methods[i].name);
        if (!(first.median > 0 && other.median > 0)) continue;
        const std::string verdict = overlap(first, other)
                                        ? " does not differ measurably (the quartiles overlap) from "
                                        : printed(" takes %.3g times as long as ", other.median / first.median);
        study.findings.push_back(methods[i].name + verdict + methods.front().name + " for the same error");
    }
}

void sweep(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
           const std::vector<ImageMethod>& methods, const AccuracyProgress& progress) {
    const ReferenceImage reference = sweep_to_reference(study, device, scene, options, methods, progress);
    for (const ImageMethod& method : methods) judge_sampling(study, method, options, reference);
    compare_efficiency(study, methods);
}

}  // namespace

Study study_sampling(const Device& device, const Scene& scene, const StudyOptions& options,
                     const AccuracyProgress& progress) {
    Study study;
    study.name = "sampling", study.title = "Samples per pixel", study.error = "RMSE / mean";
    const auto by = [&](Sampler sampler) {
        return [&device, &scene, sampler](RenderConfig config) {
            config.sampler = sampler;
            return render_image(device, scene, config);
        };
    };
    sweep(study, device, scene, options, {{"Sobol", by(Sampler::sobol)}, {"independent", by(Sampler::independent)}},
          progress);
    return study;
}

Study study_techniques(const Device& device, const Scene& scene, const StudyOptions& options,
                       const AccuracyProgress& progress) {
    Study study;
    study.name = "techniques", study.title = "Light sampling, BSDF sampling, Russian roulette";
    study.error = "RMSE / mean";
    constexpr const char* shade = "render/shade_surface";
    const auto with = [&](const char* macro, unsigned value) {
        return [&device, &scene, macro, value](const RenderConfig& config) {
            const MacroScope scope(device, {{shade, macro, value}});
            return render_image(device, scene, config);
        };
    };
    std::vector<ImageMethod> methods = {{"claray", with("TECHNIQUES", 3)},
                                        {"lights alone", with("TECHNIQUES", 1)},
                                        {"BSDFs alone", with("TECHNIQUES", 2)},
                                        {"no roulette", with("ROULETTE_DEPTH", 1u << 20)}};
    if (effects_of(scene).has(Effect::many_lights))
        methods.push_back({"lights by power", [&](RenderConfig config) {
                               config.effects.remove.add(Effect::many_lights);
                               return render_image(device, scene, config);
                           }});
    sweep(study, device, scene, options, methods, progress);
    return study;
}

}  // namespace claray
