// Studies of images: samples a pixel, and where paths end.
#include <algorithm>
#include <cmath>

#include "host/accuracy/pixels.hpp"
#include "host/accuracy/study.hpp"

namespace claray {
namespace {

struct Run {
    std::vector<glm::vec3> image;
    double seconds = 0;
};

Run run(const Device& device, const Scene& scene, RenderConfig config) {
    config.seconds = config.noise = 0;
    Renderer renderer(device, scene, config);
    const RenderProgress reached = renderer.render();
    return {renderer.image(), reached.seconds};
}

/// The part of a study that its reference takes, of what progress shows.
constexpr double reference_share = 0.5;

/// A curve of one sampler: errors and times of all its runs, a row a setting.
struct Curve {
    const char* name;
    Sampler sampler;
    std::vector<std::vector<ImageError>> errors;
    std::vector<std::vector<double>> seconds;
};

StudyPoint point_of(const Curve& curve, std::size_t setting, unsigned spp) {
    StudyPoint point;
    point.method = curve.name, point.setting = std::to_string(spp) + " spp", point.value = spp;
    std::vector<double> rmse, relmse, perceptual;
    for (const ImageError& e : curve.errors[setting]) {
        rmse.push_back(e.rmse), relmse.push_back(e.relmse), perceptual.push_back(e.perceptual);
    }
    point.runs = unsigned(rmse.size());
    if (rmse.empty()) point.failure = "was not run";
    point.error = spread_of(rmse), point.seconds = spread_of(curve.seconds[setting]);
    point.errors = {point.error.median, spread_of(relmse).median, spread_of(perceptual).median};
    return point;
}

/// How fast the error falls with the samples, and whether it stops falling.
void judge(Study& study, const Curve& curve, std::size_t first) {
    std::vector<double> samples, errors;
    for (std::size_t i = first; i < study.points.size(); ++i) {
        if (!study.points[i].failure.empty() || study.points[i].value < 2) continue;
        samples.push_back(study.points[i].value), errors.push_back(study.points[i].error.median);
    }
    if (samples.size() < 3) return;
    study.findings.push_back(std::string(curve.name) + told(": error falls with the samples to the power of %.3f",
                                                            log_log_slope(samples, errors)));
    const std::size_t tail = samples.size() - 3;
    const double end = log_log_slope(std::span(samples).subspan(tail), std::span(errors).subspan(tail));
    if (end > -0.25)
        study.findings.push_back(std::string(curve.name) +
                                 told(": falls no further at %.4f: what is left is bias", errors.back()));
}

}  // namespace

Study study_sampling(const Device& device, const Scene& scene, const StudyOptions& options,
                     const AccuracyProgress& progress) {
    Study study;
    study.name = "sampling", study.title = "Samples a pixel", study.error = "RMSE / mean";
    std::vector<unsigned> spp;
    for (unsigned s = 1; s <= options.most_spp; s *= 2) spp.push_back(s);
    Curve curves[] = {{"Sobol", Sampler::sobol, {}, {}}, {"independent", Sampler::independent, {}, {}}};
    for (Curve& curve : curves) curve.errors.resize(spp.size()), curve.seconds.resize(spp.size());

    const ReferenceImage reference = reference_image(device, scene, options.config,
                                                     {.least_spp = 64 * options.most_spp, .folder = options.references},
                                                     scaled(progress, 0, reference_share));
    study.floor = reference.uncertainty, study.reference_spp = reference.spp;
    const AccuracyProgress rest = scaled(progress, reference_share, 1);
    double samples = 0;
    const double all = double(options.runs) * 2 * (2 * spp.back());
    bool goes_on = true;
    for (unsigned round = 0; round < options.runs && goes_on; ++round)  // all settings by turns
        for (std::size_t i = 0; i < spp.size() && goes_on; ++i)
            for (Curve& curve : curves) {
                RenderConfig config = options.config;
                config.spp = spp[i], config.sampler = curve.sampler, config.seed = options.config.seed + round;
                const Run done = run(device, scene, config);
                curve.errors[i].push_back(image_error(done.image, reference.pixels, config.width));
                curve.seconds[i].push_back(done.seconds);
                samples += spp[i];
                goes_on = !rest || rest(std::min(1.0, samples / all),
                                        "run " + std::to_string(round + 1) + " of " + std::to_string(options.runs));
                if (!goes_on) break;
            }
    for (const Curve& curve : curves) {
        const std::size_t first = study.points.size();
        for (std::size_t i = 0; i < spp.size(); ++i) study.points.push_back(point_of(curve, i, spp[i]));
        judge(study, curve, first);
    }
    mark_front(study.points);
    return study;
}

namespace {

/// Squared bias without noise: the mean of (a - r)(b - r) over all pairs of independent renders, with its standard
/// error by the jackknife (leaving out one render at a time).
struct SquaredBias {
    double square = 0, standard_error = 0;
};

SquaredBias squared_bias(const std::vector<std::vector<glm::vec3>>& images, const ReferenceImage& reference,
                         double mean) {
    const std::size_t n = images.size(), pixels = reference.pixels.size();
    std::vector<double> sum_with(n);  // of products with all others
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
            double product = 0;
            for (std::size_t p = 0; p < pixels; ++p)
                product += double(glm::dot(images[i][p] - reference.pixels[p], images[j][p] - reference.pixels[p]));
            product /= 3.0 * double(pixels) * mean * mean;
            sum += product, sum_with[i] += product, sum_with[j] += product;
        }
    const double count = double(n), pairs = count * (count - 1) / 2, pairs_without_one = (count - 1) * (count - 2) / 2;
    double squares = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double off = (sum - sum_with[i]) / pairs_without_one - sum / pairs;
        squares += off * off;
    }
    // The reference's own error is in both factors.
    return {sum / pairs - reference.uncertainty * reference.uncertainty, std::sqrt((count - 1) / count * squares)};
}

StudyPoint depth_point(const Device& device, const Scene& scene, RenderConfig config, unsigned runs,
                       const ReferenceImage& reference) {
    StudyPoint point;
    point.method = "path depth", point.setting = "depth " + std::to_string(config.max_depth);
    point.value = config.max_depth, point.runs = 2 * std::max(runs, 2u);
    std::vector<std::vector<glm::vec3>> images;
    std::vector<double> seconds;
    for (unsigned i = 0; i < point.runs; ++i) {
        ++config.seed;
        Run done = run(device, scene, config);
        images.push_back(std::move(done.image)), seconds.push_back(done.seconds);
    }
    const SquaredBias bias = squared_bias(images, reference, mean_of(reference.pixels));
    const auto root = [](double square) { return std::sqrt(std::max(square, 0.0)); };
    constexpr double quartile = 0.6745;  // of a normal distribution, in standard deviations
    point.error = {root(bias.square - quartile * bias.standard_error), root(bias.square),
                   root(bias.square + quartile * bias.standard_error)};
    point.errors.rmse = point.error.median;
    point.seconds = spread_of(seconds);
    if (bias.square < 2 * bias.standard_error || point.error.median <= reference.uncertainty)
        point.failure = "no bias that can be told from noise";
    return point;
}

}  // namespace

Study study_depth(const Device& device, const Scene& scene, const StudyOptions& options,
                  const AccuracyProgress& progress) {
    Study study;
    study.name = "depth", study.title = "Where paths end", study.error = "bias, RMS / mean";
    constexpr unsigned reference_depth = 64, depths[] = {1, 2, 3, 4, 6, 8, 12, 16};
    RenderConfig config = options.config;
    config.max_depth = reference_depth;
    const ReferenceImage reference =
        reference_image(device, scene, config, {.least_spp = 64 * options.most_spp, .folder = options.references},
                        scaled(progress, 0, reference_share));
    study.floor = reference.uncertainty, study.reference_spp = reference.spp;
    const AccuracyProgress rest = scaled(progress, reference_share, 1);
    config.spp = options.most_spp;
    for (const unsigned depth : depths) {
        config.max_depth = depth;
        const StudyPoint point = depth_point(device, scene, config, options.runs, reference);
        study.points.push_back(point);
        if (point.failure.empty())
            study.findings.push_back(
                point.setting + told(" is off by %.3f %% of the mean, however many samples", 100 * point.error.median));
        if (rest && !rest(double(study.points.size()) / double(std::size(depths)), point.setting)) break;
    }
    mark_front(study.points);
    return study;
}

}  // namespace claray
