// Frames at a fixed rate: how many samples per pixel fit into one.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "host/accuracy/forecast.hpp"
#include "host/accuracy/study.hpp"
#include "host/base/percentile.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned pilot_frames = 8;  // of which the slowest counts
constexpr double share = 0.85;        // of a frame's time that is planned for
constexpr unsigned most_spp = 1024;
constexpr unsigned watched = 50;  // frames within which two late ones make the samples fewer

/// Frames of one renderer, each with a seed of its own.
class Frames {
public:
    Frames(const Device& device, const Scene& scene, const RenderConfig& config)
        : max_depth(config.max_depth), renderer_(device, scene, config), seed_(config.seed) {}

    /// Returns false if `measuring` does.
    bool wait_for_kernels(const MeasuringProgress& measuring) {
        if (measuring && !measuring("kernels")) return false;
        renderer_.settle();
        return true;
    }

    double next() {
        const Clock::time_point begin = Clock::now();
        renderer_.restart(seed_++, spp, max_depth);
        (void)renderer_.render();
        (void)renderer_.picture();
        return std::chrono::duration<double>(Clock::now() - begin).count();
    }
    /// A frame as seen by this camera.
    double next(const Camera& camera) {
        const Clock::time_point begin = Clock::now();
        scene_.camera = camera;
        renderer_.update(scene_, {.camera = true});
        return std::chrono::duration<double>(Clock::now() - begin).count() + next();
    }
    [[nodiscard]] std::vector<glm::vec3> image() const { return renderer_.image(); }
    /// The slowest of a few, after one that may compile.
    double slowest() {
        (void)next();
        double most = 0;
        for (unsigned i = 0; i < pilot_frames; ++i) most = std::max(most, next());
        return most;
    }

    unsigned spp = 1, max_depth;

private:
    Renderer renderer_;
    Scene scene_;  // without objects, to carry the camera
    std::uint32_t seed_;
};

[[noreturn]] void refuse_rate(const RenderConfig& config, double budget, double seconds) {
    const double scale = std::sqrt(share * budget / seconds);
    const double width = std::floor(config.width * scale), height = std::floor(config.height * scale);
    const std::string size = std::min(width, height) >= 1
                                 ? printed("%.4g needs about --size %.0fx%.0f", 1 / budget, width, height)
                                 : printed("%.4g is not possible at any size", 1 / budget);
    throw Error(ErrorKind::user,
                printed("%.4g frames per second cannot be reached: one sample per pixel with one surface takes %s",
                        1 / budget, told_time(seconds).c_str()),
                printed("the closest possible is about --fps %.3g; %s", share / seconds, size.c_str()));
}

/// If the deepest paths take too long, finds the deepest that fit by bisection, or those of one surface. Returns a
/// frame's time.
double pick_depth(Frames& frames, double budget) {
    double seconds = frames.slowest();
    if (seconds <= share * budget || frames.max_depth == 1) return seconds;
    unsigned fits = 1, deep = frames.max_depth;
    frames.max_depth = fits;
    seconds = frames.slowest();
    if (seconds > budget) return seconds;
    while (deep - fits > 1) {
        frames.max_depth = (fits + deep) / 2;
        const double time = frames.slowest();
        if (time <= share * budget)
            fits = frames.max_depth, seconds = time;
        else
            deep = frames.max_depth;
    }
    frames.max_depth = fits;
    return seconds;
}

/// Samples are cheaper together: doubles their number until they do not fit, and then searches between. `seconds`: the
/// time of one, and then of those picked.
void pick_samples(Frames& frames, unsigned most, double budget, double& seconds) {
    unsigned fits = 1, too_many = 0;
    while (seconds < 0.8 * budget) {
        const auto by_time = unsigned(std::min(fits * budget / seconds, double(most)));
        const unsigned next = too_many == 0 ? std::min(std::max(2 * fits, by_time), most) : (fits + too_many) / 2;
        if (next == fits) break;
        frames.spp = next;
        const double time = frames.slowest();
        if (time <= budget)
            fits = next, seconds = time;
        else
            too_many = next;
    }
    frames.spp = fits;
}

/// The most samples, and then the deepest paths, that fit.
void pick(Frames& frames, const RenderConfig& config, double budget, std::vector<std::string>& picks) {
    frames.spp = 1;
    double seconds = pick_depth(frames, budget);
    if (seconds > budget) refuse_rate(config, budget, seconds);
    const double one = seconds;
    pick_samples(frames, std::min(config.spp, most_spp), share * budget, seconds);
    picks.push_back(printed("samples: %u per pixel; one sample takes %s, a frame takes %s of %s", frames.spp,
                            told_time(one).c_str(), told_time(seconds).c_str(), told_time(budget).c_str()));
    if (frames.max_depth < config.max_depth)
        picks.push_back(
            printed("paths: at most %u surfaces instead of %u, which removes light; use a smaller --size to avoid this",
                    frames.max_depth, config.max_depth));
}

}  // namespace

FramesReport render_frames(const Device& device, const Scene& scene, const RenderConfig& config,
                           const FramesConfig& wanted, const std::function<bool(unsigned)>& progress,
                           const MeasuringProgress& measuring) {
    if (!(wanted.fps > 0 && std::isfinite(wanted.fps)) || wanted.frames == 0)
        throw Error(ErrorKind::usage, "the frame rate and the number of frames must be greater than 0",
                    "use for example 60");
    if (!std::isfinite(wanted.orbit))
        throw Error(ErrorKind::usage, "the orbit must be finite", "give degrees, for example 90");
    const double budget = 1 / wanted.fps;
    TargetPlan plan = plan_render(device, scene, config, wanted.picks_builder, measuring);
    plan.picks.clear();
    pick_for_time(plan, device, wanted.frames * budget);
    plan.config.spp = std::min(config.spp, most_spp);
    plan.config.error = plan.config.noise = plan.config.seconds = 0;
    FramesReport report;
    Frames all(device, scene, plan.config);
    if (!all.wait_for_kernels(measuring) || (measuring && !measuring("samples that fit into a frame")))
        throw Error(ErrorKind::user, "interrupted before the first frame");
    pick(all, plan.config, budget, plan.picks);
    unsigned last_late = 0;
    const float aspect = float(config.width) / float(config.height);
    const Camera camera = scene.camera ? *scene.camera : automatic_camera(bounds_of(scene), 40.f, aspect);
    for (unsigned i = 1; i <= wanted.frames; ++i) {
        const auto degrees = float(wanted.orbit * i / wanted.frames);
        report.seconds.push_back(wanted.orbit != 0 ? all.next(orbited(camera, degrees)) : all.next());
        if (progress && !progress(i)) break;
        if (report.seconds.back() <= budget) continue;
        if (last_late > 0 && i - last_late < watched && all.spp > 1) all.spp -= std::max(1u, all.spp / 8);
        last_late = i;
    }
    report.picks = plan.picks;
    report.spp = all.spp, report.max_depth = all.max_depth;
    report.median = percentile(report.seconds, 0.5), report.percentile = percentile(report.seconds, 0.99);
    report.image = all.image();
    return report;
}

}  // namespace claray
