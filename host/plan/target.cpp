// The planner: which builder and which samples reach a target soonest.
#include "claray/plan/target.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "claray/scale/render_group.hpp"
#include "host/base/format.hpp"
#include "host/plan/forecast.hpp"
#include "host/render/kernels/kernel_choice.hpp"

namespace claray {
namespace {

constexpr double least_seconds_for_pilot = 60;  // below which measuring a device doesn't pay
constexpr std::size_t pilot_triangles = 20'000;
constexpr double sure_gain = 1.25;  // by which a better tree must save more than it costs: models err
constexpr double late = 1.1;        // of a time limit

const char* name_of(Builder builder) { return traits_of(builder).name; }

double build_seconds(const DeviceModel& model, Builder builder, std::size_t triangles) {
    return 1e-9 * model.of(builder).build_nanoseconds * double(triangles);
}

/// How many times as fast as `fast` is.
double speed_of(const DeviceModel& model, Builder builder) {
    return model.of(builder).samples_per_second / model.fast.samples_per_second;
}

std::size_t triangles_of(const Scene& scene) {
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    return triangles;
}

/// On a device object of its own, so that what it runs is in nobody's statistics.
void run_pilot(TargetPlan& plan, const Device& device) {
    const Device other = Device::open(std::to_string(device.info().index));
    plan.model = measure_model(other, pilot_triangles, plan.measuring);
    if (plan.model.known())
        plan.picks.emplace_back("model: none is stored for this device (see claray tune); a short one was measured");
}

std::string why(const TargetPlan& plan, Builder builder, double seconds) {
    if (!plan.model.known())
        return printed("tree: %s; no model is stored for this device (see claray tune)", name_of(builder));
    std::string text = printed("tree: %s, for %zu triangles and about %s of sampling;", name_of(builder),
                               plan.triangles, duration_text(seconds).c_str());
    for (const Builder other : planned_builders)
        text += printed(" %s %s and %.2f times the speed%s", name_of(other),
                        duration_text(build_seconds(plan.model, other, plan.triangles)).c_str(),
                        speed_of(plan.model, other), other == std::end(planned_builders)[-1] ? "" : ",");
    return text;
}

std::string why_fixed(const TargetPlan& plan) {
    return printed(
        "tree: %s, as given: the planner chooses a tree only without --builder and for scenes without instances",
        name_of(plan.config.bvh.builder));
}

void pick_sampler(TargetPlan& plan) {
    if (plan.config.sampler != Sampler::sobol) return;
    if (!plan.model.known()) {
        plan.picks.emplace_back("samples: Sobol, with less noise for the same number");
        return;
    }
    const double cost = plan.model.independent_cost;
    plan.config.sampler = cost < 1 ? Sampler::independent : Sampler::sobol;
    plan.picks.push_back(printed("samples: %s; independent samples need %.2f times the time for the same error",
                                 cost < 1 ? "independent" : "Sobol's", cost));
}

void refuse_unreachable(const TargetPlan& plan, const Forecast& needed, const RenderProgress& so_far) {
    const double most = plan.config.spp;
    if (needed.spp <= 4 * most || plan.config.seconds > 0) return;  // a forecast errs
    const double closest = so_far.error_bound * std::sqrt(so_far.error_spp / most);
    throw Error(
        ErrorKind::user,
        printed("an error of %g cannot be reached: it needs about %.3g samples per pixel (%s), but the limit is %.0f",
                plan.config.error > 1e-20 ? plan.config.error : 0.0, needed.spp, duration_text(needed.seconds).c_str(),
                most),
        printed("the closest possible is about --error %.2g, in %s", closest,
                duration_text(most * needed.seconds_a_sample).c_str()));
}

/// `seconds`: of one sample for every pixel.
void refuse_late(const RenderConfig& config, double seconds) {
    if (!(config.seconds > 0) || seconds <= late * config.seconds || !config.resume.empty()) return;
    throw Error(ErrorKind::user,
                "a time of " + duration_text(config.seconds) + " is too short: one sample for every pixel takes " +
                    duration_text(seconds),
                "allow this time, or use a smaller --size or --max-depth");
}

}  // namespace

Builder choose_builder(const DeviceModel& model, std::size_t triangles, double seconds, Builder built) {
    if (!model.known()) return built;
    Builder best = built;
    double least = seconds / speed_of(model, built);
    for (const Builder other : planned_builders) {
        if (other == built) continue;
        const double tracing = seconds / speed_of(model, other), all = tracing + build_seconds(model, other, triangles);
        const bool sure = seconds / speed_of(model, built) - tracing > sure_gain * (all - tracing);
        if (sure && all < least) best = other, least = all;
    }
    return best;
}

void pick_for_time(TargetPlan& plan, const Device& device, double seconds) {
    if (plan.picks_builder && !plan.model.known() && seconds >= least_seconds_for_pilot) run_pilot(plan, device);
    pick_sampler(plan);
    if (plan.picks_builder && plan.model.known())
        plan.config.bvh.builder = choose_builder(plan.model, plan.triangles, seconds);
    plan.picks.push_back(plan.picks_builder ? why(plan, plan.config.bvh.builder, seconds) : why_fixed(plan));
}

namespace {

/// Before anything is known of the scene's pace. High is not among them: it is the one that may cost more than all
/// else.
Builder first_builder(const TargetPlan& plan) {
    if (!plan.model.known()) return plan.config.bvh.builder;
    DeviceModel without_high = plan.model;
    without_high.high = without_high.fast;
    return choose_builder(without_high, plan.triangles, plan.seconds_to_foresee);
}

}  // namespace

TargetPlan plan_render(const Device& device, const Scene& scene, const RenderConfig& config, bool picks_builder,
                       const MeasuringProgress& measuring) {
    TargetPlan plan;
    plan.config = config, plan.triangles = triangles_of(scene), plan.measuring = measuring;
    plan.picks_builder = picks_builder && scene.instances.empty();
    plan.config.bvh.builder = builder_for(config.bvh.builder, device, !scene.instances.empty());
    plan.model = stored_model(device);
    if (config.error == 0) {
        pick_for_time(plan, device, config.seconds);
        plan.promised_seconds = config.seconds;
        return plan;
    }
    pick_sampler(plan);
    if (plan.picks_builder) {
        const Builder first = first_builder(plan);
        plan.config.bvh.builder = first;
        plan.picks.push_back(printed("tree: %s, until the first samples predict the total time", name_of(first)));
    } else {
        plan.picks.push_back(why_fixed(plan));
    }
    return plan;
}

namespace {

/// The model is that of another scene: a tree of a higher cost by the surface area heuristic is slower in this one.
bool rebuild_if_better(Renderer& renderer, TargetPlan& plan, Builder builder) {
    const Builder before = plan.config.bvh.builder;
    const double cost = renderer.statistics().bvh.sah_cost;
    plan.config.bvh.builder = builder;
    if (!renderer.rebuild(plan.config.bvh) || renderer.statistics().bvh.sah_cost < cost) return true;
    plan.config.bvh.builder = before;
    renderer.rebuild(plan.config.bvh);
    plan.picks.push_back(
        printed("tree: %s again, since its surface area heuristic cost is lower in this scene", name_of(before)));
    return false;
}

/// The forecast of a render to an error, once it can be told. Throws if the error cannot be reached.
std::optional<Forecast> foresee(Watched& watched, const TargetPlan& plan, const RenderProgress& so_far) {
    const std::optional<Forecast> needed = watched.foresee(so_far, plan.config.error, plan.seconds_to_foresee);
    if (needed) refuse_unreachable(plan, *needed, so_far);
    return needed;
}

/// An error may need more time than there is.
double within_limit(const TargetPlan& plan, double seconds) {
    return plan.config.seconds > 0 ? std::min(seconds, plan.config.seconds) : seconds;
}

/// For the rest of the `needed` seconds.
void pick_tree_on_the_way(const Device& device, Renderer& renderer, TargetPlan& plan, double needed, double so_far) {
    plan.promised_seconds = within_limit(plan, needed);
    if (!plan.picks_builder) return;
    const double left = plan.promised_seconds - so_far;
    if (!plan.model.known() && left >= least_seconds_for_pilot) run_pilot(plan, device);
    const Builder before = plan.config.bvh.builder;
    const Builder builder = choose_builder(plan.model, plan.triangles, left, before);
    plan.picks.push_back(why(plan, builder, left));
    if (builder == before) return;
    double then = needed + build_seconds(plan.model, builder, plan.triangles);
    if (rebuild_if_better(renderer, plan, builder))
        then -= (needed - so_far) * (1 - speed_of(plan.model, before) / speed_of(plan.model, builder));
    plan.promised_seconds = within_limit(plan, then);
}

}  // namespace

RenderProgress render_to_target(const Device& device, Renderer& renderer, TargetPlan& plan,
                                const std::function<bool(const RenderProgress&)>& progress) {
    bool foresees = plan.config.error > 0;
    Watched watched;
    for (;;) {
        std::optional<double> seconds;  // that are needed, once foreseen
        double before = 0;              // seconds that have passed then
        const RenderProgress reached = renderer.render([&](const RenderProgress& so_far) {
            if (progress && !progress(so_far)) return false;
            if (!foresees) return true;
            const std::optional<Forecast> needed = foresee(watched, plan, so_far);
            if (!needed) return true;
            seconds = needed->seconds, before = so_far.seconds;
            return false;
        });
        if (!seconds) {
            if (reached.spp == 1) refuse_late(plan.config, reached.seconds);
            return reached;
        }
        foresees = false;
        pick_tree_on_the_way(device, renderer, plan, *seconds, before);
    }
}

RenderProgress render_to_target(RenderGroup& group, TargetPlan& plan,
                                const std::function<bool(const RenderProgress&)>& progress) {
    bool foresees = plan.config.error > 0;
    Watched watched;
    const RenderProgress reached = group.render([&](const RenderProgress& so_far) {
        if (progress && !progress(so_far)) return false;
        if (!foresees) return true;
        const std::optional<Forecast> needed = foresee(watched, plan, so_far);
        if (needed) foresees = false, plan.promised_seconds = within_limit(plan, needed->seconds);
        return true;
    });
    if (reached.spp > 0) refuse_late(plan.config, reached.seconds / reached.spp);  // a group ends what it has begun
    return reached;
}

Builder choose_builder_for_samples(const Device& device, const Scene& scene, const RenderConfig& config) {
    const DeviceModel model = stored_model(device);
    if (!model.known() || !scene.instances.empty()) return config.bvh.builder;
    const double samples = double(config.image_width()) * config.image_height() * config.spp;
    return choose_builder(model, triangles_of(scene), samples / model.fast.samples_per_second);
}

bool is_kept(const TargetPlan& plan, const RenderProgress& reached) {
    if (plan.config.error > 0) return reached.error_bound > 0 && reached.error_bound <= plan.config.error;
    return reached.seconds <= late * plan.config.seconds;
}

std::string account_of(const TargetPlan& plan, const RenderProgress& reached) {
    if (plan.config.error > 0) {
        std::string text = printed("error of %g, in %s", plan.config.error, duration_text(reached.seconds).c_str());
        if (plan.promised_seconds > 0)
            text += printed(" (predicted: %s)", duration_text(plan.promised_seconds).c_str());
        if (reached.error_bound == 0)
            return text + printed(": %u samples per pixel are too few to estimate the error", reached.spp);
        text += printed(": about %.3g, and less than %.3g in 98 of 100 renders", reached.error, reached.error_bound);
        if (reached.error_is_sure()) return text;
        return text + printed("; uncertain, since single bright pixels have %.0f %% of the squared error",
                              100 * reached.error_of_fireflies);
    }
    return printed("time of %s: %s, %u samples per pixel", duration_text(plan.config.seconds).c_str(),
                   duration_text(reached.seconds).c_str(), reached.spp);
}

}  // namespace claray
