// Study of bias: errors of settings that more samples do not reduce.
#include "host/accuracy/studies/bias.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/in_parallel.hpp"
#include "host/render/film/pixels.hpp"

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
    std::vector<double> products(n * n);
    in_parallel(n * n, [&](std::size_t pair) {
        const std::size_t i = pair / n, j = pair % n;
        if (i >= j) return;
        for (std::size_t p = 0; p < pixels; ++p)
            products[pair] += double(glm::dot(images[i][p] - reference.pixels[p], images[j][p] - reference.pixels[p]));
    });
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
            const double product = products[i * n + j] / (3.0 * double(pixels) * mean * mean);
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

constexpr double quartile = 0.6745;  // of a normal distribution, in standard deviations

/// The number of standard errors that chance exceeds in 2.3 of 100 cases: 2 for many renders, more for few (Student's t
/// by Cornish and Fisher's expansion: Abramowitz and Stegun 1964, 26.7.5).
double doubtful(std::size_t renders) {
    constexpr double z = 2;
    const double freedom = double(renders) - 1;
    return z + (z * z * z + z) / (4 * freedom) +
           (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * freedom * freedom);
}

/// Ambient occlusion (Landis 2002): where a path first meets a rough surface, all light but that of lamps has one
/// constant radiance. Surfaces within reach block it, and reflect it once with their albedo.
AmbientData ambient_data(float reach, glm::vec3 radiance) { return {radiance.r, radiance.g, radiance.b, reach}; }

const std::vector<MacroScope::Macro> ambient_kernels = {{"render/shade_surface", "TECHNIQUES", 1},
                                                        {"render/shade_surface", "AMBIENT", 1},
                                                        {"render/trace_paths", "TECHNIQUES", 1},
                                                        {"render/trace_paths", "AMBIENT", 1}};

/// Finds the radiance with which such an image has the mean of the true one. All images have the same seeds, so that
/// noise of parts that do not differ cancels.
class AmbientRadiance {
public:
    AmbientRadiance(const Device& device, const Scene& scene, const RenderConfig& config)
        : device_(device),
          scene_(scene),
          config_(config),
          whole_(mean_of_image({}, {})),
          dark_(mean_with(1, glm::vec3(0))) {}

    [[nodiscard]] glm::vec3 within(float reach) const {
        const glm::dvec3 added = mean_with(reach, glm::vec3(1)) - dark_;
        const glm::bvec3 any = glm::greaterThan(added, glm::dvec3(0));
        return glm::max(glm::mix(glm::dvec3(0), (whole_ - dark_) / added, any), glm::dvec3(0));
    }

private:
    [[nodiscard]] glm::dvec3 mean_with(float reach, glm::vec3 radiance) const {
        return mean_of_image(ambient_kernels, ambient_data(reach, radiance));
    }
    [[nodiscard]] glm::dvec3 mean_of_image(const std::vector<MacroScope::Macro>& macros,
                                           const AmbientData& ambient) const {
        glm::dvec3 sum(0);
        const std::vector<glm::vec3> image =
            render_with(device_, scene_, config_, macros, ambient)(config_.seed, config_.spp).image;
        for (const glm::vec3& pixel : image) sum += glm::dvec3(pixel);
        return sum / double(image.size());
    }

    const Device& device_;
    const Scene& scene_;
    RenderConfig config_;
    glm::dvec3 whole_, dark_;
};

}  // namespace

Renders render_independently(const RenderMethod& method, unsigned spp, const StudyOptions& options) {
    constexpr unsigned least = 4;  // pairs without one render tell the spread
    Renders renders;
    double seconds = 0;
    for (unsigned i = 0; i < std::max(2 * options.runs, least); ++i) {
        if (i >= least && options.most_seconds > 0 && seconds >= options.most_seconds) break;
        Rendered done = method(options.config.seed + 1 + i, spp);
        seconds += done.seconds;
        renders.images.push_back(std::move(done.image)), renders.seconds.push_back(done.seconds);
    }
    return renders;
}

StudyPoint bias_point(const std::string& method, const std::string& setting, double value, const Renders& renders,
                      const ReferenceImage& reference) {
    StudyPoint point;
    point.method = method, point.setting = setting, point.value = value, point.runs = unsigned(renders.images.size());
    const SquaredBias bias = squared_bias(renders.images, reference, mean_of(reference.pixels));
    const auto root = [](double square) { return std::sqrt(std::max(square, 0.0)); };
    point.error = {root(bias.square - quartile * bias.standard_error), root(bias.square),
                   root(bias.square + quartile * bias.standard_error)};
    point.errors.rmse = point.error.median;
    point.seconds = spread_of(renders.seconds);
    if (bias.square < doubtful(renders.images.size()) * bias.standard_error ||
        point.error.median <= reference.uncertainty)
        point.failure = "no bias above the noise";
    return point;
}

std::vector<float> bias_map(const Renders& renders, const ReferenceImage& reference) {
    const double mean = mean_of(reference.pixels), n = double(renders.images.size());
    std::vector<float> map(reference.pixels.size());
    for (std::size_t p = 0; p < map.size(); ++p) {
        glm::dvec3 sum(0), squares(0);  // sum over pairs = ((sum of all)^2 - sum of squares) / 2
        for (const std::vector<glm::vec3>& image : renders.images) {
            const glm::dvec3 off = glm::dvec3(image[p]) - glm::dvec3(reference.pixels[p]);
            sum += off, squares += off * off;
        }
        const glm::dvec3 product = (sum * sum - squares) / (n * (n - 1));
        map[p] = float(std::sqrt(std::max((product.x + product.y + product.z) / 3, 0.0)) / mean);
    }
    return map;
}

/// Every approximation that the scene has a use for, with the variants of the light grid.
std::vector<RenderConfig> approximated_renders(const Scene& scene, const RenderConfig& config,
                                               const Approximations& among) {
    std::vector<RenderConfig> all;
    for (const Approximations& approximate : approximations_for(scene, among)) {
        RenderConfig how = config;
        how.approximate = approximate;
        all.push_back(how);
        if (!approximate.light_grid) continue;
        for (const LightGridConfig& grid :
             {LightGridConfig{.coefficients = 4}, LightGridConfig{.side = 32}, LightGridConfig{.gather = 1},
              LightGridConfig{.voxels = true, .side = 32}}) {
            how.light_grid = grid;
            all.push_back(how);
        }
    }
    return all;
}

std::string name_of(const RenderConfig& how) {
    const LightGridConfig& grid = how.light_grid;
    if (!how.approximate.light_grid) return to_string(how.approximate);
    if (grid.voxels) return printed("light-grid, %u^3 voxels", grid.side);
    return printed("light-grid, %u^3 x %u%s", grid.side, grid.coefficients, grid.gather > 0 ? ", gathered" : "");
}

Study study_bias(const Device& device, const Scene& scene, const StudyOptions& options,
                 const AccuracyProgress& progress) {
    Study study;
    study.name = "bias", study.title = "Bias of short paths, clamped samples and approximations";
    study.error = "bias, RMS / mean";
    constexpr unsigned depths[] = {1, 2, 3, 4, 6, 8, 12, 16, 32, default_max_depth};
    constexpr double clamps[] = {1000, 100, 30, 10, 3, 1};
    constexpr float reaches[] = {0, 1 / 32.f, 1 / 8.f, 1 / 2.f};  // shares of the scene's size
    // With the default depth it is the reference of all studies, whose paths lose almost no light.
    StudyOptions deep = options;
    deep.config.max_depth = std::max(options.config.max_depth, default_max_depth);
    const ReferenceImage reference = reference_for(study, device, scene, deep, options.most_spp, progress);
    RenderConfig config = deep.config;
    const AccuracyProgress rest = scaled(progress, reference_share, 1);
    config.spp = single_spp(options);
    const std::vector<RenderConfig> approximated = approximated_renders(scene, config, options.approximations);
    const double settings =
        double(std::size(depths) + std::size(clamps) + std::size(reaches) + 1 + approximated.size());
    bool goes_on = true;
    const auto add_images = [&](const char* method, const std::string& setting, double value,
                                const RenderMethod& render) {
        if (!goes_on) return;
        const Renders renders = render_independently(render, config.spp, options);
        const StudyPoint point = bias_point(method, setting, value, renders, reference);
        if (point.failure.empty())
            study.findings.push_back(std::string(method) + ", " + setting +
                                     printed(": bias of %.3f %% of the mean", 100 * point.error.median));
        study.points.push_back(point);
        if (options.measured) options.measured(study);
        goes_on = !rest || rest(double(study.points.size()) / settings, setting);
    };
    const auto add = [&](const char* method, const std::string& setting, double value, const RenderConfig& how,
                         const std::vector<MacroScope::Macro>& macros) {
        add_images(method, setting, value, render_with(device, scene, how, macros));
    };
    KeptRenderer of_all_depths(device, scene, config);
    for (const unsigned depth : depths)
        add_images("path depth", printed(depth == default_max_depth ? "depth %u (default)" : "depth %u", depth), depth,
                   [&](std::uint32_t seed, unsigned spp) { return of_all_depths.render(seed, spp, depth); });
    const double mean = mean_of(reference.pixels);
    for (const double clamp : clamps) {
        RenderConfig how = config;
        how.sample_clamp = float(clamp * mean);
        add("samples clamped", printed("at %g x mean", clamp), clamp, how, {});
    }
    add("no caustics", "no caustics", 0, config, {{"render/shade_surface", "CAUSTICS", 0}});
    for (const RenderConfig& how : approximated) add("approximations", name_of(how), 0, how, {});
    if (goes_on) {
        const float size = glm::length(bounds_of(scene).extent());
        const AmbientRadiance ambient(device, scene, config);
        for (const float share : reaches) {
            const float reach = std::max(share * size, std::numeric_limits<float>::min());
            add_images("ambient occlusion", share > 0 ? printed("within %g of the scene", share) : "without occlusion",
                       share,
                       render_with(device, scene, config, ambient_kernels, ambient_data(reach, ambient.within(reach))));
        }
    }
    mark_front(study.points);
    return study;
}

}  // namespace claray
