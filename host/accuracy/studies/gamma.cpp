// Study of gamma: lights that are added as values of the sRGB curve.
#include <algorithm>
#include <cmath>

#include "host/accuracy/studies/image_sweep.hpp"
#include "host/base/color.hpp"
#include "host/base/in_parallel.hpp"
#include "host/render/film/image_error.hpp"
#include "host/render/film/pixels.hpp"

namespace claray {
namespace {

constexpr std::size_t most_groups = 8;

/// The sRGB curve (IEC 61966-2-1), continued beyond 1: sums are not clipped, which would be another error.
double encoded(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// The numbers of a scene's light sources: its lights, its materials that emit, its sky or environment.
struct LightSources {
    explicit LightSources(const Scene& scene) : lights(scene.lights.size()) {
        for (std::size_t i = 0; i < scene.materials.size(); ++i)
            if (scene.materials[i].emission != glm::vec3(0.f)) lamps.push_back(i);
        sky = !scene.environment.images.empty() || scene.sky.horizon + scene.sky.zenith != glm::vec3(0.f);
    }
    [[nodiscard]] std::size_t count() const { return lights + lamps.size() + sky; }

    std::size_t lights;
    std::vector<std::size_t> lamps;
    bool sky;
};

/// The scene under one of `groups` groups of its light sources.
Scene with_group(Scene scene, const LightSources& sources, std::size_t group, std::size_t groups) {
    std::size_t source = 0;
    const auto is_in = [&] { return source++ % groups == group; };
    std::erase_if(scene.lights, [&](const Light&) { return !is_in(); });
    for (const std::size_t lamp : sources.lamps)
        if (!is_in()) scene.materials[lamp].emission = glm::vec3(0.f);
    if (sources.sky && !is_in()) scene.sky = {}, scene.environment = {};
    return scene;
}

/// Every `step`-th image is added up as light; the sums are added up as values of the curve.
std::vector<glm::vec3> added_as_values(const std::vector<std::vector<glm::vec3>>& images, std::size_t step) {
    std::vector<glm::vec3> image(images[0].size());
    constexpr std::size_t together = 1024;
    in_parallel((image.size() + together - 1) / together, [&](std::size_t piece) {
        for (std::size_t p = piece * together; p < std::min((piece + 1) * together, image.size()); ++p)
            for (int c = 0; c < 3; ++c) {
                double values = 0;
                for (std::size_t first = 0; first < step; ++first) {
                    double light = 0;
                    for (std::size_t i = first; i < images.size(); i += step) light += double(images[i][p][c]);
                    values += encoded(light);
                }
                image[p][c] = float(decode_srgb(values));
            }
    });
    return image;
}

/// By the number of groups, over all runs.
struct GammaErrors {
    std::vector<double> rmse, relmse, perceptual, brightness;
};

StudyPoint point_of_groups(std::size_t groups, std::size_t sources, const GammaErrors& errors,
                           const std::vector<double>& seconds) {
    StudyPoint point;
    point.method = "sRGB values added", point.value = double(groups), point.runs = unsigned(errors.rmse.size());
    point.setting = printed(groups == sources ? "%zu lights" : "%zu groups", groups);
    point.error = spread_of(errors.rmse), point.seconds = spread_of(seconds);
    point.errors = {point.error.median, spread_of(errors.relmse).median, spread_of(errors.perceptual).median};
    point.facts = {{"mean brightness", spread_of(errors.brightness).median}};
    return point;
}

}  // namespace

Study study_gamma(const Device& device, const Scene& scene, const StudyOptions& options,
                  const AccuracyProgress& progress) {
    Study study;
    study.name = "gamma", study.title = "Lights added as sRGB values";
    study.error = "RMSE / mean";
    const LightSources sources(scene);
    const std::size_t most = std::min(sources.count(), most_groups);
    if (most < 2) {
        study.findings.emplace_back("the scene has one light source: there is nothing to add");
        return study;
    }
    const RenderConfig config = with_spp(options, single_spp(options));
    std::vector<Scene> scenes;
    std::vector<RenderMethod> methods;
    for (std::size_t group = 0; group < most; ++group) scenes.push_back(with_group(scene, sources, group, most));
    for (const Scene& lit : scenes) methods.push_back(render_with(device, lit, config));
    std::vector<std::size_t> steps;
    for (std::size_t groups = 2; groups < most; groups *= 2) steps.push_back(groups);
    steps.push_back(most);
    std::vector<GammaErrors> errors(steps.size());
    begin_timing(options);
    std::vector<double> seconds;
    double taken = 0;
    for (unsigned run = 0; run < options.runs; ++run) {
        if (run > 0 && options.most_seconds > 0 && taken >= options.most_seconds) break;
        std::vector<std::vector<glm::vec3>> images;
        double all_seconds = 0;
        for (std::size_t group = 0; group < most; ++group) {
            Rendered done = methods[group](config.seed + run, config.spp);
            images.push_back(std::move(done.image)), all_seconds += done.seconds;
            const double part = double(run * most + group + 1) / double(options.runs * most);
            if (progress && !progress(part, printed("group %zu of %zu", group + 1, most))) return study;
        }
        seconds.push_back(all_seconds), taken += all_seconds;
        std::vector<glm::vec3> whole = images[0];
        for (std::size_t i = 1; i < most; ++i)
            for (std::size_t p = 0; p < whole.size(); ++p) whole[p] += images[i][p];
        const ErrorAgainst error_of(whole, config.width);
        for (std::size_t i = 0; i < steps.size(); ++i) {
            const std::vector<glm::vec3> values = added_as_values(images, steps[i]);
            const ImageError error = error_of(values);
            errors[i].rmse.push_back(error.rmse), errors[i].relmse.push_back(error.relmse);
            errors[i].perceptual.push_back(error.perceptual);
            errors[i].brightness.push_back(mean_of(values) / std::max(mean_of(whole), 1e-30));
        }
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
        study.points.push_back(point_of_groups(steps[i], sources.count(), errors[i], seconds));
        study.findings.push_back(printed("%s added as sRGB values: error of %.3g %% of the mean, %.3g times as bright",
                                         study.points.back().setting.c_str(), 100 * study.points.back().error.median,
                                         fact_of(study.points.back(), "mean brightness")));
    }
    mark_front(study.points);
    return study;
}

}  // namespace claray
