#include "host/accuracy/studies/image_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/render/film/image_error.hpp"

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

/// All runs of a sweep, by method and number of samples.
using SweepRuns = std::vector<std::vector<Runs>>;

void add_points(Study& study, const std::vector<ImageMethod>& methods, const std::vector<unsigned>& spp,
                const SweepRuns& runs) {
    for (std::size_t m = 0; m < methods.size(); ++m)
        for (std::size_t i = 0; i < spp.size(); ++i)
            study.points.push_back(point_of(methods[m].name, runs[m][i], spp[i]));
    mark_front(study.points);
}

void tell_measured(const Study& study, const StudyOptions& options, const std::vector<ImageMethod>& methods,
                   const std::vector<unsigned>& spp, const SweepRuns& runs) {
    if (!options.measured) return;
    Study so_far = study;
    add_points(so_far, methods, spp, runs);
    std::erase_if(so_far.points, [](const StudyPoint& p) { return p.runs == 0; });
    options.measured(so_far);
}

/// The squares of both errors add up, since image and reference are independent. Errors below half of the reference's
/// own are not known.
double without_floor(double rmse, double floor) {
    return rmse > floor ? std::sqrt(std::max(rmse * rmse - floor * floor, floor * floor / 4)) : rmse;
}

/// Whether a setting has taken `most` seconds by the mean of all methods. Methods have equally many runs, since some
/// compare their image with that of another.
bool has_taken(const SweepRuns& runs, std::size_t setting, double most) {
    double sum = 0;
    for (const std::vector<Runs>& of_method : runs)
        sum = std::accumulate(of_method[setting].seconds.begin(), of_method[setting].seconds.end(), sum);
    return most > 0 && sum >= most * double(runs.size());
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

ReferenceImage reference_for(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
                             unsigned spp, const AccuracyProgress& progress) {
    const unsigned factor = options.reference_factor;
    ReferenceImage reference =
        reference_image(device, scene, options.config,
                        {.least_spp = factor * spp,
                         .render_spp = std::clamp(ReferenceOptions{}.render_spp, spp, factor * spp),
                         .least_renders = options.reference_renders,
                         .seed = options.reference_seed,
                         .folder = options.references},
                        scaled(progress, 0, reference_share));
    study.floor = reference.uncertainty, study.reference_spp = reference.spp;
    begin_timing(options);
    return reference;
}

void sweep_samples(Study& study, const StudyOptions& options, unsigned most_spp,
                   const std::vector<ImageMethod>& methods, const ImageJudge& judge, const AccuracyProgress& progress) {
    std::vector<unsigned> spp;
    for (unsigned s = options.first_spp; s <= most_spp; s *= 2) spp.push_back(s);
    SweepRuns runs(methods.size(), std::vector<Runs>(spp.size()));
    double samples = 0;
    const double all = double(options.runs) * double(methods.size()) * (2 * spp.back() - spp.front());
    bool goes_on = true;
    for (const ImageMethod& method : methods)  // loads its kernels; no measured render continues it
        (void)method.render(options.config.seed + options.runs, 1);
    begin_timing(options);
    for (unsigned round = 0; round < options.runs && goes_on; ++round)
        for (std::size_t i = 0; i < spp.size() && goes_on; ++i) {
            if (has_taken(runs, i, options.most_seconds)) {
                samples += spp[i] * double(methods.size());
                continue;
            }
            for (std::size_t m = 0; m < methods.size() && goes_on; ++m) {
                samples += spp[i];
                const Rendered done = methods[m].render(options.config.seed + round, spp[i]);
                runs[m][i].errors.push_back(judge(done.image));
                runs[m][i].seconds.push_back(done.seconds);
                goes_on = !progress || progress(samples / all, methods[m].name + ", run " + std::to_string(round + 1) +
                                                                   " of " + std::to_string(options.runs));
            }
            tell_measured(study, options, methods, spp, runs);
        }
    add_points(study, methods, spp, runs);
}

ReferenceImage sweep_to_reference(Study& study, const Device& device, const Scene& scene, const StudyOptions& options,
                                  unsigned most_spp, const std::vector<ImageMethod>& methods,
                                  const AccuracyProgress& progress) {
    const ReferenceImage reference = reference_for(study, device, scene, options, options.most_spp, progress);
    const ErrorAgainst error_of(reference.pixels, options.config.width);
    sweep_samples(
        study, options, most_spp, methods,
        [&](const std::vector<glm::vec3>& image) {
            ImageError error = error_of(image);
            error.rmse = without_floor(error.rmse, reference.uncertainty);
            return error;
        },
        scaled(progress, reference_share, 1));
    tell_cut_off(study, device, scene, options.config);
    return reference;
}

}  // namespace claray
