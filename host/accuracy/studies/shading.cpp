// Study of shading models: flat and Gouraud shading of a ball against Phong shading, over its number of triangles.
#include <string>

#include "host/accuracy/image_error.hpp"
#include "host/accuracy/studies/image_sweep.hpp"

namespace claray {

Study study_shading(const Device& device, const Scene&, const StudyOptions& options, const AccuracyProgress& progress) {
    constexpr unsigned counts[] = {32, 100, 320, 1000, 3200, 10000, 32000};
    constexpr std::pair<const char*, Approximations> models[] = {{"flat", {.tile_sum = true, .flat = true}},
                                                                 {"gouraud", {.tile_sum = true, .gouraud = true}}};
    Study study;
    study.name = "shading", study.title = "Shading models: a ball (ball:N) against Phong shading of the same triangles";
    study.error = "RMSE / mean";
    RenderConfig config = options.config;
    config.spp = options.single_spp == 0 ? std::min(options.most_spp, 16u) : options.single_spp;
    std::size_t done = 0;
    for (const auto& [name, model] : models)
        for (const unsigned count : counts) {
            const std::string setting = std::to_string(count) + " triangles";
            if (progress && !progress(double(done++) / double(2 * std::size(counts)), setting)) return study;
            const Scene ball = *builtin_scene("ball:" + std::to_string(count));
            config.approximate = {.tile_sum = true};
            const Rendered phong = render_image(device, ball, config);
            const ErrorAgainst error_of(phong.image, config.width);
            config.approximate = model;
            const RenderMethod render = render_with(device, ball, config);
            StudyPoint point;
            point.method = name, point.setting = setting, point.value = double(count), point.runs = options.runs;
            std::vector<double> seconds, ratios;
            for (unsigned run = 0; run < std::max(options.runs, 1u); ++run) {
                const Rendered seen = render(config.seed, config.spp);
                if (run == 0) point.errors = error_of(seen.image);
                seconds.push_back(seen.seconds), ratios.push_back(seen.seconds / phong.seconds);
            }
            const double error = point.errors.rmse;  // the samples are the same: no noise
            point.error = {error, error, error}, point.seconds = spread_of(seconds);
            point.facts = {{"time / Phong's", spread_of(ratios).median}};
            study.findings.push_back(name + (", " + setting) +
                                     printed(": differs by %.3g %% of the mean", 100 * error));
            study.points.push_back(point);
        }
    mark_front(study.points);
    return study;
}

}  // namespace claray
