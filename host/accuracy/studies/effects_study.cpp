// Study of effects: error and time saved without each effect.
#include <algorithm>
#include <cmath>

#include "host/accuracy/studies/bias.hpp"
#include "host/render/film/pixels.hpp"

namespace claray {
namespace {

/// RMS error of each pixel over renders and channels, divided by the reference's mean.
std::vector<float> noise_map(const Renders& renders, const ReferenceImage& reference) {
    const double mean = mean_of(reference.pixels);
    std::vector<float> map(reference.pixels.size());
    for (std::size_t p = 0; p < map.size(); ++p) {
        double squares = 0;
        for (const std::vector<glm::vec3>& image : renders.images) {
            const glm::dvec3 off = glm::dvec3(image[p]) - glm::dvec3(reference.pixels[p]);
            squares += glm::dot(off, off) / 3;
        }
        map[p] = float(std::sqrt(squares / double(renders.images.size())) / mean);
    }
    return map;
}

/// Materials without their kind become `lambert`, which therefore cannot be left out.
std::vector<Effect> effects_to_leave_out(const Scene& scene) {
    const EffectSet called_for = effects_of(scene);
    std::vector<Effect> effects;
    for (const Effect effect : all_effects())
        if (called_for.has(effect) && effect != Effect::lambert) effects.push_back(effect);
    return effects;
}

}  // namespace

Study study_effects(const Device& device, const Scene& scene, const StudyOptions& options,
                    const AccuracyProgress& progress, std::vector<ErrorMap>* maps) {
    Study study;
    study.name = "effects", study.title = "Effects: error and time saved without each";
    study.error = "bias without it, RMS / mean", study.sweeps = false;
    const ReferenceImage reference = reference_for(study, device, scene, options, options.most_spp, progress);
    const AccuracyProgress rest = scaled(progress, reference_share, 1);
    const RenderConfig config = with_spp(options, single_spp(options));
    const Renders whole = render_independently(render_with(device, scene, config), config.spp, options);
    const double seconds = spread_of(whole.seconds).median;
    StudyPoint all;
    all.method = "all effects", all.setting = "nothing left out", all.runs = unsigned(whole.images.size());
    all.seconds = spread_of(whole.seconds);
    study.points.push_back(all);
    if (maps) maps->push_back({"noise", noise_map(whole, reference)});
    const std::vector<Effect> effects = effects_to_leave_out(scene);
    for (const Effect effect : effects) {
        const std::string name = name_of(effect);
        RenderConfig without = config;
        without.effects.remove.add(effect);
        const Renders renders = render_independently(render_with(device, scene, without), without.spp, options);
        StudyPoint point = bias_point("left out", name, 0, renders, reference);
        const double saved = 100 * (1 - point.seconds.median / seconds);
        point.facts = {{"time saved, %", saved}};
        if (point.failure.empty())
            study.findings.push_back(name +
                                     printed(": without it the image differs by %.3g %% of its mean and is rendered ",
                                             100 * point.error.median) +
                                     told_time_against(point.seconds, study.points.front().seconds));
        study.points.push_back(point);
        if (options.measured) options.measured(study);
        if (maps) maps->push_back({"without-" + name, bias_map(renders, reference)});
        if (rest && !rest(double(study.points.size()) / double(effects.size() + 1), "without " + name)) break;
    }
    mark_front(study.points);
    return study;
}

}  // namespace claray
