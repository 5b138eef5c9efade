#include "host/measure/explain.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <optional>

#include "host/base/format.hpp"
#include "host/compute/contexts.hpp"
#include "host/compute/programs/compiler_processes.hpp"
#include "host/measure/measure.hpp"
#include "host/render/kernels/kernel_choice.hpp"
#include "host/render/wavefront/wavefront.hpp"

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
        if (name != "measure_film" && name != "write_buffer" && name != "read_buffer" && name != "map_buffer")
            total += summary.milliseconds;
    return total / spp;
}

/// Compiles kernels once more for their times: `beside` in a thread and a context of its own, one after the other,
/// while the caller's kernels are compiled; else, as on CPUs, whose cores do both, when a time is asked for.
class BuildTimes {
public:
    BuildTimes(const Device& device, bool beside) : device_(device), beside_(beside) {}
    ~BuildTimes() { wait(); }
    BuildTimes(const BuildTimes&) = delete;
    BuildTimes& operator=(const BuildTimes&) = delete;
    [[nodiscard]] bool beside() const { return beside_; }

    /// Until none compiles beside the caller.
    void wait() const {
        if (beside_ && last_.valid()) last_.wait();
    }
    /// Compiled once for every set of macros.
    std::shared_future<BuildReport> of(const ProgramRequest& program) {
        std::shared_future<BuildReport>& report = reports_[to_text(program)];
        if (report.valid()) return report;
        const auto build = [this, before = last_, program] {
            if (!beside_) return report_build(device_, program.file, program.defines);
            if (before.valid()) before.wait();
            if (!own_context_) own_context_ = Device::open(std::to_string(device_.info().index));
            return report_build(*own_context_, program.file, program.defines);
        };
        report = std::async(beside_ ? std::launch::async : std::launch::deferred, build).share();
        return last_ = report;
    }

private:
    Device device_;
    bool beside_;
    std::optional<Device> own_context_;
    std::map<std::string, std::shared_future<BuildReport>> reports_;
    std::shared_future<BuildReport> last_;
};

/// The builds of one variant.
struct VariantBuilds {
    std::vector<std::shared_future<BuildReport>> all;
    std::shared_future<BuildReport> shading;  ///< if it is among them

    void tell(Variant& variant) const {
        for (const std::shared_future<BuildReport>& report : all)
            variant.compile_milliseconds += report.get().milliseconds;
        if (!shading.valid()) return;
        variant.registers = shading.get().registers, variant.spill_bytes = shading.get().spill_bytes;
    }
};

/// A variant beside the scene's own kernels.
struct Comparison {
    EffectOverrides overrides;
    Variant variant = {};  ///< without its builds
    double ratio = 1;
    bool noise = false;
    VariantBuilds builds = {}, own_builds = {};  ///< of the kernels in which they differ
};

class Explainer {
public:
    Explainer(const Device& device, const Scene& scene, const RenderConfig& config, const ExplainOptions& options)
        : device_(device),
          scene_(scene),
          config_(config),
          options_(options),
          times_(device, options.compile_beside.value_or(device.info().type == DeviceType::gpu)) {
        config_.spp = spp_on(device, config);
        config_.compiler.clear();
    }

    /// Begins the builds for the compile times that `prepare` will ask for, where these are beside it.
    void expect_builds(const EffectOverrides& overrides) {
        if (!times_.beside()) return;
        const KernelSet own = kernels_of(config_);
        (void)builds_of(own), (void)builds_of(kernels_of(with(overrides)), own);
    }
    /// With the kernels of all renders, on a GPU: its driver compiles for several contexts at once, and more so for
    /// several processes. Errors are left to `prepare`, which needs memory for one renderer at a time.
    void fill_cache(const std::vector<EffectOverrides>& overrides,
                    const std::vector<Approximations>& approximations) const {
        if (device_.info().type != DeviceType::gpu) return;
        std::vector<RenderConfig> configs = {config_};
        for (const EffectOverrides& each : overrides) configs.push_back(with(each));
        for (const Approximations& each : approximations) configs.push_back(with(each));
        std::erase_if(configs, [&](const RenderConfig& config) { return is_cached(config); });
        if (configs.size() < 2) return;
        const unsigned most = has_compiler_processes(device_) ? 2 * contexts_at_once() : contexts_at_once();
        Devices contexts(device_);
        side_by_side(device_, contexts, most, configs.size(), [&](const Device& device, std::size_t i) {
            try {
                Renderer(device, scene_, configs[i]).settle();
            } catch (const std::exception&) {
            }
        });
    }
    /// Compiles all kernels of a variant, and of the scene's own; call it for all variants before `compare_with_own`.
    void prepare(Comparison& comparison) {
        compile(config_), compile(with(comparison.overrides));
        const KernelSet own = kernels_of(config_), other = kernels_of(with(comparison.overrides));
        own_builds_ = builds_of(own);
        comparison.own_builds = builds_of(own, other), comparison.builds = builds_of(other, own);
    }
    void prepare(const Approximations& approximate) { compile(config_), compile(with(approximate)); }
    /// Until nothing is compiled any more: that would slow down what is measured.
    void wait_for_builds() const { times_.wait(); }

    void compare_with_own(Comparison& comparison) {
        Renderer own(device_, scene_, config_), other(device_, scene_, with(comparison.overrides));
        const PairedTimes times = compare(device_, own, other, options_.rounds);
        own_times_.push_back(times.first);
        own_bytes_ = own.statistics().device_bytes;
        comparison.variant.milliseconds = times.second;
        comparison.variant.bytes = other.statistics().device_bytes;
        comparison.ratio = times.ratio, comparison.noise = times.noise;
    }

    /// Its time, and by how much it changes the image.
    [[nodiscard]] ExplainedApproximation compare_with_truth(const Approximations& approximate) {
        const RenderConfig config = with(approximate);
        Renderer own(device_, scene_, config_), other(device_, scene_, config);
        const PairedTimes times = compare(device_, own, other, options_.rounds);
        if (truth_.empty()) truth_ = image_of(config_);
        return {approximate, times.ratio, times.noise, difference(image_of(config), truth_)};
    }

    [[nodiscard]] Variant own() const {
        Variant variant;
        own_builds_.tell(variant);
        variant.milliseconds = median(own_times_), variant.bytes = own_bytes_;
        return variant;
    }

private:
    [[nodiscard]] RenderConfig with(const EffectOverrides& overrides) const {
        RenderConfig config = config_;
        config.effects = overrides;
        return config;
    }
    [[nodiscard]] RenderConfig with(const Approximations& approximate) const {
        RenderConfig config = config_;
        config.approximate = approximate;
        return config;
    }

    [[nodiscard]] SceneTraits traits_for(const RenderConfig& config) const {
        const EffectSet& removed = config.effects.remove;
        return removed.empty() ? traits_of(scene_) : traits_of(without_effects(scene_, removed));
    }
    [[nodiscard]] bool is_cached(const RenderConfig& config) const {
        return are_cached(device_, scene_kernels(device_, traits_for(config), config).programs);
    }
    /// Without those that build trees.
    [[nodiscard]] KernelSet kernels_of(const RenderConfig& config) const {
        const SceneTraits traits = traits_for(config);
        const KernelChoice own = scene_kernels(device_, traits, config);
        return programs_of_stages(device_, stages_for(device_, traits, config, own.effects, own.layout));
    }

    void compile(const RenderConfig& config) const { Renderer(device_, scene_, config).settle(); }

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

    /// Of kernels that the other set lacks.
    VariantBuilds builds_of(const KernelSet& kernels, const KernelSet& other = {}) {
        VariantBuilds builds;
        if (!options_.compile_times) return builds;
        for (const ProgramRequest& program : kernels.programs()) {
            if (std::count(other.programs().begin(), other.programs().end(), program) != 0) continue;
            builds.all.push_back(times_.of(program));
            if (program.file == "render/shade_surface.cl") builds.shading = builds.all.back();
        }
        return builds;
    }

    Device device_;
    const Scene& scene_;
    RenderConfig config_;
    ExplainOptions options_;
    BuildTimes times_;
    std::vector<double> own_times_;
    std::uint64_t own_bytes_ = 0;
    VariantBuilds own_builds_;
    std::vector<glm::vec3> truth_;  // the image without approximations
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
    std::size_t told = 0, all = rows.size() + (options.everything ? 1 : 0) - std::size_t(fixed) + approximations.size();
    const auto tell = [&](const char* step, const std::string& what) {
        if (progress) progress(printed("%s %s (%zu of %zu)", step, what.c_str(), ++told, all));
        if (told == all) told = 0;
    };
    const Scene stripped = config.effects.remove.empty() ? Scene() : without_effects(scene, config.effects.remove);
    const Scene& explained = config.effects.remove.empty() ? scene : stripped;
    RenderConfig plain = config;
    plain.effects = {};
    Explainer explainer(device, explained, plain, options);
    Explanation explanation;
    struct Named {
        std::string name;
        Comparison comparison;
    };
    std::vector<Named> compared;  // of everything, if that is measured, and of the rows that are not fixed
    if (options.everything) compared.push_back({"with everything compiled in", {{full_effects(), {}}}});
    for (const ExplainedEffect& row : rows) {
        if (row.fixed) continue;
        const EffectOverrides overrides =
            row.called_for ? EffectOverrides{{}, {row.effect}} : EffectOverrides{{row.effect}, {}};
        const std::string name = std::string(row.called_for ? "without " : "with ") + name_of(row.effect);
        compared.push_back({name, {overrides}});
    }
    std::optional<KeepCompilers> keep(std::in_place);  // while kernels are compiled
    std::vector<EffectOverrides> overrides;
    for (const Named& named : compared) {
        overrides.push_back(named.comparison.overrides);
        explainer.expect_builds(named.comparison.overrides);
    }
    explainer.fill_cache(overrides, approximations);
    for (Named& named : compared) {
        tell("compiling kernels", named.name);
        explainer.prepare(named.comparison);
    }
    for (const Approximations& approximate : approximations) {
        tell("compiling kernels for", to_string(approximate));
        explainer.prepare(approximate);
    }
    keep.reset();
    explainer.wait_for_builds();
    for (Named& named : compared) {
        tell("measuring", named.name);
        explainer.compare_with_own(named.comparison);
    }
    for (const Approximations& approximate : approximations) {
        tell("measuring", to_string(approximate));
        explanation.approximations.push_back(explainer.compare_with_truth(approximate));
    }
    // Ratios of pairs are more reliable than separate times, since the machine may have been busy during one of them.
    explanation.own = explainer.own();
    auto next = compared.begin();
    const auto take = [&](Variant& variant, double& ratio, bool& noise) {
        variant = next->comparison.variant, ratio = next->comparison.ratio, noise = next->comparison.noise;
        variant.milliseconds = explanation.own.milliseconds * ratio;
        next->comparison.builds.tell(variant);
    };
    if (options.everything) take(explanation.full, explanation.full_ratio, explanation.full_noise), ++next;
    for (ExplainedEffect& row : rows) {
        if (row.fixed) continue;
        take(row.other, row.ratio, row.noise);
        Variant own;
        next++->comparison.own_builds.tell(own);
        row.own_compile_milliseconds = own.compile_milliseconds;
    }
    explanation.effects = std::move(rows);
    return explanation;
}

}  // namespace claray::measure
