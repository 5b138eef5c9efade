// Studies of samples: how fast noise falls, by sampler and by technique.
#include <algorithm>
#include <cmath>

#include "host/accuracy/studies/bias.hpp"
#include "host/accuracy/studies/image_sweep.hpp"

namespace claray {
namespace {

/// How fast the error falls with the samples. If it stops falling, new renders show whether the reason is bias, or rare
/// bright samples that are in few of the images.
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
    const Renders renders = render_independently(with.render, unsigned(samples.back()), options);
    const StudyPoint bias = bias_point(method, "", 0, renders, reference);
    study.findings.push_back(
        method +
        (bias.failure.empty()
             ? printed(": stops decreasing at %.3g %%: %.3g %% of this is bias, or light that no render has found",
                       100 * errors.back(), 100 * bias.error.median)
             : printed(": decreases slowly at %.3g %%, due to rare bright samples; %s", 100 * errors.back(),
                       bias.failure.c_str())));
}

/// Of the most samples that were rendered often enough for quartiles, if any were.
const StudyPoint* last_repeated(const Study& study, const std::string& method) {
    constexpr unsigned enough = 3;
    const auto last = std::find_if(study.points.rbegin(), study.points.rend(), [&](const StudyPoint& p) {
        return p.method == method && p.failure.empty() && p.runs >= enough;
    });
    return last == study.points.rend() ? last_of(study, method) : &*last;
}

/// error^2 * seconds of the most samples: the cost of an error, which does not depend on the number of samples. If
/// these were rendered once, the spread is that of fewer samples.
Spread cost_of(const Study& study, const std::string& method) {
    const StudyPoint *last = last_of(study, method), *repeated = last_repeated(study, method);
    if (!last) return {};
    const auto cost = [](double error, double seconds) { return error * error * seconds; };
    const double median = cost(last->error.median, last->seconds.median),
                 share = median / cost(repeated->error.median, repeated->seconds.median);
    return {share * cost(repeated->error.low, repeated->seconds.low), median,
            share * cost(repeated->error.high, repeated->seconds.high)};
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

void sweep(Study& study, const Device& device, const Scene& scene, const StudyOptions& options, unsigned most_spp,
           const std::vector<ImageMethod>& methods, const AccuracyProgress& progress) {
    const ReferenceImage reference = sweep_to_reference(study, device, scene, options, most_spp, methods, progress);
    for (const ImageMethod& method : methods) judge_sampling(study, method, options, reference);
    compare_efficiency(study, methods);
}

}  // namespace

Study study_sampling(const Device& device, const Scene& scene, const StudyOptions& options,
                     const AccuracyProgress& progress) {
    Study study;
    study.name = "sampling", study.title = "Samples per pixel", study.error = "RMSE / mean";
    const auto by = [&](Sampler sampler, bool adaptive = false) {
        RenderConfig config = with_spp(options, options.most_spp);
        config.sampler = sampler, config.adaptive = adaptive;
        return render_with(device, scene, config);
    };
    sweep(study, device, scene, options, options.most_spp,
          {{"Sobol", by(Sampler::sobol)},
           {"independent", by(Sampler::independent)},
           {"adaptive", by(Sampler::sobol, true)}},
          progress);
    return study;
}

Study study_techniques(const Device& device, const Scene& scene, const StudyOptions& options,
                       const AccuracyProgress& progress) {
    Study study;
    study.name = "techniques", study.title = "Light sampling, BSDF sampling, Russian roulette";
    study.error = "RMSE / mean";
    RenderConfig config = with_spp(options, compared_spp(options));
    const auto with = [&](const char* macro, unsigned value) {
        return render_with(device, scene, config, {{"render/shade_surface", macro, value}});
    };
    std::vector<ImageMethod> methods = {{"claray", render_with(device, scene, config)},
                                        {"lights alone", with("TECHNIQUES", 1)},
                                        {"BSDFs alone", with("TECHNIQUES", 2)},
                                        {"no roulette", with("ROULETTE_DEPTH", 1u << 20)}};
    constexpr EffectSet picking = {Effect::light_lists, Effect::many_lights};
    if (!(effects_of(scene) & picking).empty()) {
        config.effects.remove = config.effects.remove | picking;
        methods.push_back({"lights by power", render_with(device, scene, config)});
    }
    sweep(study, device, scene, options, compared_spp(options), methods, progress);
    return study;
}

// The same images against a second, larger reference.
ErrorCheck check_errors(const Device& device, const Scene& scene, const StudyOptions& options,
                        const AccuracyProgress& progress) {
    constexpr unsigned larger = 16;
    const double share = 1.0 / (1 + larger);
    ErrorCheck check;
    check.reported = study_sampling(device, scene, options, scaled(progress, 0, share));
    StudyOptions again = options;
    again.reference_factor = larger * options.reference_factor;
    again.reference_seed = options.reference_seed ^ 0x40000000u;
    check.independent = study_sampling(device, scene, again, scaled(progress, share, 1));
    std::vector<double> samples, errors;
    for (std::size_t i = 0; i < check.reported.points.size(); ++i) {
        const StudyPoint &a = check.reported.points[i], &b = check.independent.points[i];
        if (!a.failure.empty() || !b.failure.empty()) continue;
        const double off = std::fabs(a.error.median / b.error.median - 1);
        check.points += 1, check.within += off <= 0.1;
        check.worst = std::max(check.worst, off);
        if (a.method == "independent") samples.push_back(a.value), errors.push_back(a.error.median);
    }
    check.slope = log_log_slope(samples, errors);
    return check;
}

}  // namespace claray
