// Study of filters: textures looked up in three ways, and images of fewer pixels.
#include <algorithm>
#include <cmath>

#include "host/accuracy/image_sweep.hpp"

namespace claray {
namespace {

Scene filtered(Scene scene, Filter filter) {
    for (Texture& texture : scene.textures) texture.filter = filter;
    return scene;
}

/// An image of fewer pixels at the size of `width` x `height`, bilinear between the pixels' centres.
std::vector<glm::vec3> enlarged(const std::vector<glm::vec3>& image, unsigned from_width, unsigned from_height,
                                unsigned width, unsigned height) {
    std::vector<glm::vec3> large(std::size_t(width) * height);
    const auto at = [&](int x, int y) {
        x = std::clamp(x, 0, int(from_width) - 1), y = std::clamp(y, 0, int(from_height) - 1);
        return image[std::size_t(y) * from_width + std::size_t(x)];
    };
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x) {
            const float fx = (float(x) + 0.5f) * float(from_width) / float(width) - 0.5f;
            const float fy = (float(y) + 0.5f) * float(from_height) / float(height) - 0.5f;
            const int x0 = int(std::floor(fx)), y0 = int(std::floor(fy));
            large[std::size_t(y) * width + x] =
                glm::mix(glm::mix(at(x0, y0), at(x0 + 1, y0), fx - float(x0)),
                         glm::mix(at(x0, y0 + 1), at(x0 + 1, y0 + 1), fx - float(x0)), fy - float(y0));
        }
    return large;
}

}  // namespace

Study study_filtering(const Device& device, const Scene& scene, const StudyOptions& options,
                      const AccuracyProgress& progress) {
    Study study;
    study.name = "filtering", study.title = "Texture filters, and images of fewer pixels";
    study.error = "RMSE / mean";
    const Scene point = filtered(scene, Filter::nearest), bilinear = filtered(scene, Filter::bilinear),
                trilinear = filtered(scene, Filter::trilinear);
    const auto with = [&device](const Scene& how) {
        return [&device, &how](const RenderConfig& config) { return render_image(device, how, config); };
    };
    const auto smaller = [&](unsigned divisor) {
        return [&device, &bilinear, divisor](RenderConfig config) {
            const unsigned width = config.width, height = config.height;
            config.width = std::max(1u, width / divisor), config.height = std::max(1u, height / divisor);
            Rendered done = render_image(device, bilinear, config);
            done.image = enlarged(done.image, config.width, config.height, width, height);
            return done;
        };
    };
    std::vector<ImageMethod> methods = {{"bilinear", with(bilinear)}};
    if (scene.textures.empty())
        methods[0].name = "all pixels", study.findings.emplace_back("the scene has no texture to filter");
    else
        methods.insert(methods.end(), {{"nearest", with(point)}, {"trilinear", with(trilinear)}});
    methods.insert(methods.end(), {{"a quarter of the pixels", smaller(2)}, {"a 16th of the pixels", smaller(4)}});
    const ReferenceImage reference = reference_for(study, device, bilinear, options, progress);
    sweep_samples(
        study, options, methods,
        [&](const std::vector<glm::vec3>& image, const RenderConfig& config) {
            return image_error(image, reference.pixels, config.width);
        },
        scaled(progress, reference_share, 1));
    for (const ImageMethod& method : methods) {
        const StudyPoint* last = nullptr;
        for (const StudyPoint& p : study.points)
            if (p.method == method.name && p.failure.empty()) last = &p;
        if (last)
            study.findings.push_back(method.name + told(": error %.3g at %s, after %.3g s", last->error.median,
                                                        last->setting.c_str(), last->seconds.median));
    }
    return study;
}

}  // namespace claray
