// Denoisers: their time, the error that is left, and how much of it is blur.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>

#include "host/accuracy/studies/bias.hpp"
#include "host/accuracy/studies/image_sweep.hpp"

namespace claray {
namespace {

constexpr unsigned spp_of_blur = 16;

/// Seconds are those of sampling, and of `finish`, which brings the image to the host.
RenderMethod finish_with(const Device& device, const Scene& scene, const RenderConfig& config,
                         std::function<std::vector<glm::vec3>(const Renderer&)> finish) {
    return [kept = std::make_shared<KeptRenderer>(device, scene, config), finish = std::move(finish)](
               std::uint32_t seed, unsigned spp) {
        using Clock = std::chrono::steady_clock;
        const double sampling = kept->render(seed, spp).seconds;
        const Clock::time_point begin = Clock::now();
        std::vector<glm::vec3> image = finish(*kept->renderer());
        return Rendered{std::move(image), sampling + std::chrono::duration<double>(Clock::now() - begin).count()};
    };
}

RenderMethod denoise_with(const Device& device, const Scene& scene, const StudyOptions& options, DenoiserKind kind) {
    const RenderConfig config = with_spp(options, std::max(compared_spp(options), spp_of_blur));
    return finish_with(device, scene, config, [kind](const Renderer& renderer) { return renderer.denoised(kind); });
}

/// The error that the denoised images of different seeds have in common is blur; the rest is noise.
void tell_blur(Study& study, const ImageMethod& method, const StudyOptions& options, const ReferenceImage& reference) {
    const unsigned spp = std::clamp(spp_of_blur, std::min(options.first_spp, options.most_spp), options.most_spp);
    const StudyPoint blur =
        bias_point(method.name, "", 0, render_independently(method.render, spp, options), reference);
    study.findings.push_back(method.name + (blur.failure.empty()
                                                ? printed(": blurs by %.3g %% of the mean at %u samples per pixel",
                                                          100 * blur.error.median, spp)
                                                : printed(": no blur above the noise at %u samples per pixel", spp)));
}

const StudyPoint* point_of(const Study& study, const std::string& method, double spp) {
    for (const StudyPoint& p : study.points)
        if (p.method == method && p.value == spp && p.failure.empty()) return &p;
    return nullptr;
}

using Measure = double (*)(const StudyPoint&);
double rmse_of(const StudyPoint& p) { return p.error.median; }
/// The root, so that a gain means as much as that of the RMSE.
double relative_error_of(const StudyPoint& p) { return std::sqrt(p.errors.relmse); }

/// The error of plain samples after this time: log-linear between the two points around it.
double error_of_plain(const Study& study, const std::string& plain, double seconds, Measure error_of) {
    const StudyPoint *before = nullptr, *after = nullptr;
    for (const StudyPoint& p : study.points) {
        if (p.method != plain || !p.failure.empty()) continue;
        if (p.seconds.median <= seconds) before = &p;
        if (p.seconds.median > seconds && !after) after = &p;
    }
    if (!before || !after) return 0;
    const double part =
        std::log(seconds / before->seconds.median) / std::log(after->seconds.median / before->seconds.median);
    return error_of(*before) * std::pow(error_of(*after) / error_of(*before), part);
}

/// "1.9 at 1, 3.1 at 4": empty if samples alone were never as slow.
std::string told_gains(const Study& study, const std::string& plain, const std::string& method, Measure error_of) {
    std::string gains;
    for (unsigned spp = 1; spp <= 1u << 16; spp *= 4) {
        const StudyPoint* p = point_of(study, method, spp);
        const double error = p ? error_of_plain(study, plain, p->seconds.median, error_of) : 0;
        if (error > 0) gains += printed("%s%.2f at %u", gains.empty() ? "" : ", ", error / error_of(*p), spp);
    }
    return gains;
}

/// Fireflies, also those of the reference, hold much of the RMSE and little of the relative error.
void compare_at_equal_time(Study& study, const std::string& plain, const std::string& method) {
    const std::string gains = told_gains(study, plain, method, rmse_of);
    if (gains.empty()) return;
    study.findings.push_back(method + ": the error of more samples in the same time, over its own, is " + gains +
                             " samples per pixel");
    study.findings.push_back(method + ": the same of the root of relMSE, which fireflies affect less, is " +
                             told_gains(study, plain, method, relative_error_of));
}

}  // namespace

Study study_denoising(const Device& device, const Scene& scene, const StudyOptions& options,
                      const AccuracyProgress& progress) {
    Study study;
    study.name = "denoising", study.title = "Denoisers", study.error = "RMSE / mean";
    const std::string plain = "samples alone";
    std::vector<ImageMethod> methods = {{plain, finish_with(device, scene, with_spp(options, compared_spp(options)),
                                                            [](const Renderer& renderer) { return renderer.image(); })},
                                        {"claray", denoise_with(device, scene, options, DenoiserKind::claray)}};
    if (picked_denoiser(DenoiserKind::automatic) == DenoiserKind::oidn)
        methods.push_back({"Open Image Denoise", denoise_with(device, scene, options, DenoiserKind::oidn)});
    const ReferenceImage reference =
        sweep_to_reference(study, device, scene, options, compared_spp(options), methods, progress);
    for (std::size_t m = 1; m < methods.size(); ++m) {
        compare_at_equal_time(study, plain, methods[m].name);
        tell_blur(study, methods[m], options, reference);
    }
    return study;
}

}  // namespace claray
