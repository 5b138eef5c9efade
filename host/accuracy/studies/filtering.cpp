// Study of filters: three texture filters, and images of fewer pixels.
#include <algorithm>

#include "host/accuracy/studies/image_sweep.hpp"
#include "host/render/film/pixels.hpp"

namespace claray {
namespace {

Scene filtered(Scene scene, Filter filter) {
    for (Texture& texture : scene.textures) texture.filter = filter;
    return scene;
}

}  // namespace

Study study_filtering(const Device& device, const Scene& scene, const StudyOptions& options,
                      const AccuracyProgress& progress) {
    Study study;
    study.name = "filtering", study.title = "Texture filters, and images of fewer pixels";
    study.error = "RMSE / mean";
    const Scene point = filtered(scene, Filter::nearest), bilinear = filtered(scene, Filter::bilinear),
                trilinear = filtered(scene, Filter::trilinear);
    const RenderConfig whole = with_spp(options, compared_spp(options));
    const auto smaller = [&](unsigned divisor) {
        RenderConfig config = whole;
        config.width = std::max(1u, whole.width / divisor), config.height = std::max(1u, whole.height / divisor);
        return [config, whole, render = render_with(device, bilinear, config)](std::uint32_t seed, unsigned spp) {
            Rendered done = render(seed, spp);
            done.image = enlarged(done.image, config.width, config.height, whole.width, whole.height);
            return done;
        };
    };
    std::vector<ImageMethod> methods = {{"bilinear", render_with(device, bilinear, whole)}};
    if (scene.textures.empty())
        methods[0].name = "all pixels", study.findings.emplace_back("the scene has no texture to filter");
    else
        methods.insert(methods.end(), {{"nearest", render_with(device, point, whole)},
                                       {"trilinear", render_with(device, trilinear, whole)}});
    methods.insert(methods.end(), {{"a quarter of the pixels", smaller(2)}, {"a 16th of the pixels", smaller(4)}});
    sweep_to_reference(study, device, bilinear, options, compared_spp(options), methods, progress);
    for (const ImageMethod& method : methods) {
        if (const StudyPoint* last = last_of(study, method.name))
            study.findings.push_back(method.name + printed(": error %.3g at %s, after %.3g s", last->error.median,
                                                           last->setting.c_str(), last->seconds.median));
    }
    return study;
}

}  // namespace claray
