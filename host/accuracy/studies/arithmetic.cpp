// Studies of arithmetic: fast math, and the precision of sums of samples.
#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/gtc/packing.hpp>

#include "host/accuracy/studies/image_sweep.hpp"
#include "host/measure/measure.hpp"
#include "host/render/film/film.hpp"
#include "host/render/film/image_error.hpp"

namespace claray {
namespace {

using Macros = std::vector<MacroScope::Macro>;

constexpr const char *film = "render/accumulate_film", *sums = "CLARAY_TEXTBOOK_SUMS", *fast = "CLARAY_FAST_MATH";
const Macros sums_in_one = {{film, sums, 1}}, sums_in_half = {{film, sums, 2}}, sums_in_double = {{film, sums, 3}};
const Macros fast_shading = {{"render/shade_surface", fast, 1}, {"render/generate_rays", fast, 1}};
const Macros fast_everything = {{"render/shade_surface", fast, 1},
                                {"render/generate_rays", fast, 1},
                                {"trace/closest_hit", fast, 1},
                                {"trace/any_hit", fast, 1}};

/// Errors and times at the largest number of samples.
void judge_arithmetic(Study& study, const std::vector<ImageMethod>& methods) {
    const StudyPoint* strict = last_of(study, methods.front().name);
    for (std::size_t i = 1; strict && i < methods.size(); ++i) {
        const StudyPoint* p = last_of(study, methods[i].name);
        if (!p || p->setting != strict->setting || !(strict->seconds.median > 0)) continue;
        study.findings.push_back(
            p->method + printed(" changes the image by %.2g of its mean at %s, ", p->error.median, p->setting.c_str()) +
            told_time_against(p->seconds, strict->seconds));
    }
}

// ---- sums of many samples ------------------------------------------------------------------------------------------

constexpr std::uint32_t sum_pixels = 4, samples_a_batch = 1u << 14;

/// Heavy-tailed radiance, as of paths: exp(2 x) with x nearly normal, scaled so that sums of 2^20 do not overflow half
/// precision.
std::vector<float> radiance_of_batch() {
    std::vector<float> radiance(3 * std::size_t(sum_pixels) * samples_a_batch);
    std::uint64_t state = 1;
    for (std::size_t i = 0; i < radiance.size(); i += 3) {
        double normal = -6;
        for (int k = 0; k < 12; ++k) {
            state = state * 6364136223846793005ull + 1442695040888963407ull;  // PCG's generator (O'Neill 2014)
            normal += double(state >> 40) * 0x1p-24;
        }
        radiance[i] = radiance[i + 1] = radiance[i + 2] = float(0x1p-10 * std::exp(2 * normal));
    }
    return radiance;
}

struct SumMethod {
    const char* name;
    Macros macros;
};

StudyPoint sum_point(const Device& device, const SumMethod& method, std::uint32_t samples,
                     const Buffer<float>& radiance, const std::vector<double>& means, unsigned runs) {
    const MacroScope scope(device, method.macros);
    StudyPoint point;
    point.method = method.name, point.setting = printed("2^%.0f", std::log2(double(samples)));
    point.value = samples, point.runs = runs;
    std::vector<glm::vec3> image;
    const auto timings =
        measure::measure_rounds(device, int(runs), {[&] {
                                    Film sums_of_samples(device, sum_pixels);
                                    for (std::uint32_t at = 0; at < samples; at += samples_a_batch)
                                        sums_of_samples.accumulate({0, sum_pixels, at, samples_a_batch, 0}, radiance);
                                    image = sums_of_samples.image();
                                }});
    point.seconds = spread_of(timings[0].rounds, 1e3 / (double(samples) * sum_pixels));
    std::vector<double> errors;
    for (std::size_t p = 0; p < means.size(); ++p) errors.push_back(std::fabs(double(image[p].x) / means[p] - 1));
    if (!std::all_of(errors.begin(), errors.end(), [](double e) { return std::isfinite(e); }))
        point.failure = "overflow";
    point.error = spread_of(errors);
    return point;
}

}  // namespace

Study study_arithmetic(const Device& device, const Scene& scene, const StudyOptions& options,
                       const AccuracyProgress& progress) {
    Study study;
    study.name = "arithmetic", study.title = "Arithmetic: differences of images with the same samples";
    study.error = "RMS difference / mean";
    // One kernel per stage for all: strict images alone could use the kernel for whole paths, which is faster.
    const MacroScope stages(device, {{"render/trace_paths", "MOST_EFFECTS", 0}});
    std::optional<ErrorAgainst> strict;  // the image of the same samples
    const RenderConfig config = with_spp(options, compared_spp(options));
    const auto with = [&](const Macros& macros) { return render_with(device, scene, config, macros); };
    const RenderMethod render = with({});
    const auto render_strict = [&](std::uint32_t seed, unsigned spp) {
        Rendered done = render(seed, spp);
        strict.emplace(done.image, config.width);
        return done;
    };
    const auto render_half = [&](std::uint32_t seed, unsigned spp) {
        Rendered done = render(seed, spp);
        for (glm::vec3& c : done.image) c = glm::unpackHalf(glm::packHalf(c));
        return done;
    };
    const std::vector<ImageMethod> methods = {{"strict", render_strict},
                                              {"fast shading", with(fast_shading)},
                                              {"fast shading and tracing", with(fast_everything)},
                                              {"image in half", render_half},
                                              {"sums in float32", with(sums_in_one)},
                                              {"sums in half", with(sums_in_half)}};
    sweep_samples(
        study, options, compared_spp(options), methods,
        [&](const std::vector<glm::vec3>& image) { return (*strict)(image); }, progress);
    judge_arithmetic(study, methods);
    return study;
}

Study study_sums(const Device& device, const Scene&, const StudyOptions& options, const AccuracyProgress& progress) {
    Study study;
    study.name = "sums", study.title = "Summing samples: relative error of a pixel's mean";
    study.error = "relative error", study.cost = "seconds per 10^6 samples";
    std::vector<SumMethod> methods = {
        {"two floats", {}}, {"one float", sums_in_one}, {"half", sums_in_half}, {"float64", sums_in_double}};
    if (!device.info().fp64) methods.pop_back();
    const std::vector<float> host = radiance_of_batch();
    std::vector<double> means(sum_pixels);
    for (std::size_t i = 0; i < host.size(); i += 3)
        means[i / 3 / samples_a_batch] += double(host[i]) / samples_a_batch;
    const Buffer<float> radiance(device, host);
    std::vector<std::uint32_t> settings;
    for (std::uint64_t n = samples_a_batch; n <= 16 * std::uint64_t(options.rays); n *= 4)
        settings.push_back(std::uint32_t(std::min<std::uint64_t>(n, 1u << 31)));
    double done = 0;
    bool goes_on = true;
    for (const SumMethod& method : methods)
        for (const std::uint32_t samples : settings) {
            if (!goes_on) break;
            // The longest ones once: each run has the same error, and long times vary little.
            const unsigned runs = samples > settings.back() / 16 ? 1 : std::max(options.runs, 1u);
            study.points.push_back(sum_point(device, method, samples, radiance, means, runs));
            done += samples;
            const double all = double(methods.size()) * 4.0 / 3.0 * settings.back();
            goes_on = !progress || progress(std::min(1.0, done / all), method.name);
        }
    mark_front(study.points);
    for (const SumMethod& method : methods) {
        if (const StudyPoint* last = last_of(study, method.name))
            study.findings.push_back(printed("%s: after %s samples the error of the mean is %.2g", method.name,
                                             last->setting.c_str(), last->error.median));
    }
    return study;
}

}  // namespace claray
