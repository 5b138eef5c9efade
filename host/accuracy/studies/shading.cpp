// Study of shading models: flat and Gouraud shading of a ball against Phong shading, over its number of triangles.
#include <string>

#include "host/accuracy/studies/image_sweep.hpp"
#include "host/render/film/image_error.hpp"

namespace claray {
namespace {

constexpr unsigned counts[] = {32, 100, 320, 1000, 3200, 10000, 32000};
constexpr std::pair<const char*, Approximations> models[] = {{"flat", {.tile_sum = true, .flat = true}},
                                                             {"gouraud", {.tile_sum = true, .gouraud = true}}};

StudyPoint point_of_model(const char* name, unsigned count, const Rendered& phong, const RenderConfig& config,
                          const RenderMethod& render, const StudyOptions& options) {
    StudyPoint point;
    point.method = name, point.setting = std::to_string(count) + " triangles", point.value = double(count);
    std::vector<double> seconds, ratios;
    double taken = 0;
    for (unsigned run = 0; run < std::max(options.runs, 1u); ++run) {
        if (run > 0 && options.most_seconds > 0 && taken >= options.most_seconds) break;
        const Rendered seen = render(config.seed, config.spp);
        if (run == 0) point.errors = image_error(seen.image, phong.image, config.width);
        seconds.push_back(seen.seconds), ratios.push_back(seen.seconds / phong.seconds), taken += seen.seconds;
    }
    point.runs = unsigned(seconds.size());
    const double error = point.errors.rmse;  // the samples are the same: no noise
    point.error = {error, error, error}, point.seconds = spread_of(seconds);
    point.facts = {{"time / Phong's", spread_of(ratios).median}};
    return point;
}

}  // namespace

Study study_shading(const Device& device, const Scene&, const StudyOptions& options, const AccuracyProgress& progress) {
    Study study;
    study.name = "shading", study.title = "Shading models: a ball (ball:N) against Phong shading of the same triangles";
    study.error = "RMSE / mean";
    RenderConfig config = options.config;
    config.spp = options.single_spp == 0 ? std::min(options.most_spp, 16u) : options.single_spp;
    begin_timing(options);
    std::vector<StudyPoint> points[std::size(models)];
    for (std::size_t i = 0; i < std::size(counts); ++i) {
        const Scene ball = *builtin_scene("ball:" + std::to_string(counts[i]));
        config.approximate = {.tile_sum = true};
        const Rendered phong = render_image(device, ball, config);
        for (std::size_t m = 0; m < std::size(models); ++m) {
            config.approximate = models[m].second;
            points[m].push_back(
                point_of_model(models[m].first, counts[i], phong, config, render_with(device, ball, config), options));
        }
        if (progress && !progress(double(i + 1) / double(std::size(counts)), points[0].back().setting)) break;
    }
    for (const std::vector<StudyPoint>& of_model : points)
        for (const StudyPoint& point : of_model) {
            study.findings.push_back(point.method + (", " + point.setting) +
                                     printed(": differs by %.3g %% of the mean", 100 * point.error.median));
            study.points.push_back(point);
        }
    mark_front(study.points);
    return study;
}

}  // namespace claray
