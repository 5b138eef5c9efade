#include "host/measure/explain.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/effects/effects.hpp"
#include "host/measure/measure.hpp"

namespace claray::measure {
namespace {

/// Samples per render. CPUs: few, as in a short render. GPUs: enough that the largest pass, which has half of them,
/// fills an eighth of the queues: the time of a sample then differs little from that of a long render.
unsigned spp_on(const Device& device, const RenderConfig& config) {
    if (device.info().type == DeviceType::cpu) return 4;
    const std::uint64_t pixels = std::max<std::uint64_t>(1, std::uint64_t(config.width) * config.height);
    return unsigned(std::max<std::uint64_t>(16, device.tuning("render/wavefront", "PATHS") / 4 / pixels));
}

constexpr int rounds_before = 2;  // in which a render finds its batches' size and its kernels

/// Mean device time per sample of every pixel, without the kernels that measure the image.
double milliseconds_of_frame(const Device& device, Renderer& renderer) {
    device.finish();
    device.profiler().reset();
    renderer.restart(0);
    const unsigned spp = renderer.render().spp;
    double total = 0;
    for (const auto& [name, summary] : device.profiler().summary())
        if (name != "measure_film" && name != "write_buffer" && name != "read_buffer") total += summary.milliseconds;
    return total / spp;
}

class Explainer {
public:
    Explainer(const Device& device, const Scene& scene, const RenderConfig& config, const ExplainOptions& options)
        : device_(device), scene_(scene), config_(config), options_(options) {
        config_.spp = spp_on(device, config);
        config_.compiler.clear();
    }

    /// Compares a variant with the scene's own kernels.
    Variant compare_with_own(const EffectOverrides& overrides, EffectSet concerned, double& ratio, bool& noise) {
        RenderConfig config = config_;
        config.effects = overrides;
        Renderer own(device_, scene_, config_), other(device_, scene_, config);
        const PairedTimes times = compare(device_, own, other, options_.rounds);
        own_times_.push_back(times.first);
        own_bytes_ = own.statistics().device_bytes;
        own_effects_ = own.statistics().effects;
        ratio = times.ratio, noise = times.noise;
        Variant variant = compiled(other.statistics().effects | overrides.add, concerned);
        variant.milliseconds = times.second, variant.bytes = other.statistics().device_bytes;
        return variant;
    }

    /// Its time, and by how much it changes the image.
    [[nodiscard]] ExplainedApproximation compare_with_truth(const Approximations& approximate) const {
        RenderConfig config = config_;
        config.approximate = approximate;
        Renderer own(device_, scene_, config_), other(device_, scene_, config);
        const PairedTimes times = compare(device_, own, other, options_.rounds);
        return {approximate, times.ratio, times.noise, difference(image_of(config), image_of(config_))};
    }

    [[nodiscard]] Variant own() {
        Variant variant = compiled(own_effects_, full_effects());
        variant.milliseconds = median(own_times_), variant.bytes = own_bytes_;
        return variant;
    }
    /// Compile time of those of the scene's own kernels that contain these effects.
    [[nodiscard]] double own_compilation(EffectSet concerned) {
        return compiled(own_effects_, concerned).compile_milliseconds;
    }

private:
    [[nodiscard]] std::vector<glm::vec3> image_of(RenderConfig config) const {
        config.spp = std::max(config.spp, 64u);
        Renderer renderer(device_, scene_, config);
        (void)renderer.render();
        return renderer.image();
    }

    /// Root mean square over the mean of `truth`.
    static double difference(const std::vector<glm::vec3>& image, const std::vector<glm::vec3>& truth) {
        double squares = 0, sum = 0;
        for (std::size_t i = 0; i < image.size(); ++i) {
            const glm::dvec3 off = glm::dvec3(image[i]) - glm::dvec3(truth[i]);
            squares += glm::dot(off, off), sum += truth[i].x + truth[i].y + truth[i].z;
        }
        const double values = 3.0 * double(image.size());
        return sum > 0 ? std::sqrt(squares / values) / (sum / values) : 0;
    }

    /// Compiles the kernels that contain one of the concerned effects.
    Variant compiled(EffectSet effects, EffectSet concerned) {
        Variant variant;
        if (!options_.compile_times) return variant;
        const std::pair<Stage, const char*> files[] = {{Stage::generate, "render/generate_rays.cl"},
                                                       {Stage::trace, "trace/closest_hit.cl"},
                                                       {Stage::trace, "trace/any_hit.cl"},
                                                       {Stage::shade, "render/shade_surface.cl"}};
        for (const auto& [stage, file] : files) {
            const auto is_part = [&, at = stage](Effect effect) {
                return concerned.has(effect) && concerns(effect, at);
            };
            if (!std::any_of(all_effects().begin(), all_effects().end(), is_part)) continue;
            const BuildReport& report = build(file, defines_for(effects, stage));
            variant.compile_milliseconds += report.milliseconds;
            if (stage == Stage::shade) variant.registers = report.registers, variant.spill_bytes = report.spill_bytes;
            if (std::string(file) == "trace/closest_hit.cl" && wide() && has_cutouts(effects))
                variant.compile_milliseconds += build("trace/cutouts.cl", {{"CLARAY_WIDE", "1"}}).milliseconds;
        }
        return variant;
    }

    [[nodiscard]] bool wide() const { return device_.tuning("trace/closest_hit", "WIDE") != 0; }
    static bool has_cutouts(EffectSet effects) { return effects.has(Effect::cut_outs) || effects.has(Effect::culling); }

    /// Kernels that trace are compiled for a structure; those of a wide one leave cut-outs to trace/cutouts.cl.
    [[nodiscard]] Defines defines_for(EffectSet effects, Stage stage) const {
        if (stage != Stage::trace) return defines_of(effects, stage);
        return {{"CLARAY_WIDE", wide() ? "1" : "0"}, {"CLARAY_CUTOUTS", !wide() && has_cutouts(effects) ? "1" : "0"}};
    }

    /// Compiled once for every set of macros.
    const BuildReport& build(const std::string& file, const Defines& defines) {
        std::string key = file;
        for (const auto& [name, value] : defines) key += ' ' + name + '=' + value;
        const auto found = builds_.find(key);
        if (found != builds_.end()) return found->second;
        return builds_.emplace(key, report_build(device_, file, defines)).first->second;
    }

    std::map<std::string, BuildReport> builds_;
    Device device_;
    const Scene& scene_;
    RenderConfig config_;
    ExplainOptions options_;
    std::vector<double> own_times_;
    std::uint64_t own_bytes_ = 0;
    EffectSet own_effects_;
};

}  // namespace

/// Fewer ratios agree by chance in more than one of sixteen comparisons.
constexpr std::size_t least_to_agree = 5;

bool is_noise(const std::vector<double>& ratios) {
    const auto above = std::size_t(std::count_if(ratios.begin(), ratios.end(), [](double r) { return r > 1; }));
    return ratios.size() < least_to_agree || std::min(above, ratios.size() - above) > ratios.size() / 8;
}

PairedTimes compare(const Device& device, Renderer& first, Renderer& second, int rounds) {
    std::vector<double> firsts, seconds, ratios;
    for (int round = -rounds_before; round < rounds; ++round) {
        double a = 0, b = 0;
        if (round % 2 == 0)
            a = milliseconds_of_frame(device, first), b = milliseconds_of_frame(device, second);
        else
            b = milliseconds_of_frame(device, second), a = milliseconds_of_frame(device, first);
        if (round < 0 || !(a > 0)) continue;
        firsts.push_back(a), seconds.push_back(b), ratios.push_back(b / a);
    }
    return {median(firsts), median(seconds), median(ratios), is_noise(ratios)};
}

std::vector<ExplainedEffect> effects_to_explain(const Scene& scene, const RenderConfig& config, EffectSet only) {
    const Scene stripped = config.effects.remove.empty() ? Scene() : without_effects(scene, config.effects.remove);
    const Scene& explained = config.effects.remove.empty() ? scene : stripped;
    const EffectSet called_for = effects_of(explained);
    const std::vector<EffectCause> causes = causes_of_effects(explained);
    std::vector<ExplainedEffect> rows;
    for (const Effect effect : all_effects()) {
        if (!only.has(effect)) continue;
        ExplainedEffect row;
        row.effect = effect;
        row.called_for = called_for.has(effect);
        row.fixed = row.called_for && effect == Effect::lambert;
        for (const EffectCause& cause : causes)
            if (cause.effect == effect) row.cause = cause;
        rows.push_back(std::move(row));
    }
    return rows;
}

Explanation explain(const Device& device, const Scene& scene, const RenderConfig& config, const ExplainOptions& options,
                    const std::function<void(const std::string&)>& progress) {
    std::vector<ExplainedEffect> rows = effects_to_explain(scene, config, options.only);
    const auto fixed = std::count_if(rows.begin(), rows.end(), [](const ExplainedEffect& row) { return row.fixed; });
    const std::vector<Approximations> approximations = approximations_for(scene, options.approximations);
    std::size_t told = 0;
    const auto tell = [&](const std::string& what) {
        if (!progress) return;
        progress(
            what + " (" + std::to_string(++told) + " of " +
            std::to_string(rows.size() + (options.everything ? 1 : 0) - std::size_t(fixed) + approximations.size()) +
            ")");
    };
    const Scene stripped = config.effects.remove.empty() ? Scene() : without_effects(scene, config.effects.remove);
    const Scene& explained = config.effects.remove.empty() ? scene : stripped;
    RenderConfig plain = config;
    plain.effects = {};
    Explainer explainer(device, explained, plain, options);
    Explanation explanation;
    if (options.everything) {
        tell("everything compiled in");
        explanation.full = explainer.compare_with_own({full_effects(), {}}, full_effects(), explanation.full_ratio,
                                                      explanation.full_noise);
    }
    for (ExplainedEffect& row : rows) {
        if (row.fixed) continue;
        const Effect effect = row.effect;
        tell(std::string(row.called_for ? "without " : "with ") + name_of(effect));
        const EffectOverrides overrides =
            row.called_for ? EffectOverrides{{}, {effect}} : EffectOverrides{{effect}, {}};
        row.other = explainer.compare_with_own(overrides, {effect}, row.ratio, row.noise);
        row.own_compile_milliseconds = explainer.own_compilation({effect});
    }
    for (const Approximations& approximate : approximations) {
        tell(to_string(approximate));
        explanation.approximations.push_back(explainer.compare_with_truth(approximate));
    }
    // Ratios of pairs are more reliable than separate times, since the machine may have been busy during one of them.
    explanation.own = explainer.own();
    explanation.full.milliseconds = explanation.own.milliseconds * explanation.full_ratio;
    for (ExplainedEffect& row : rows)
        if (!row.fixed) row.other.milliseconds = explanation.own.milliseconds * row.ratio;
    explanation.effects = std::move(rows);
    return explanation;
}

}  // namespace claray::measure
