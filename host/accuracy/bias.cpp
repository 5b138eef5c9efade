// Study of bias: what settings leave out for ever.
#include <algorithm>
#include <cmath>

#include "host/accuracy/image_sweep.hpp"
#include "host/accuracy/pixels.hpp"

namespace claray {
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
        Rendered done = render_image(device, scene, config);
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
