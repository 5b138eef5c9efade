// Frames at a fixed rate: how many samples per pixel fit into one.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "claray/image/image_error.hpp"
#include "host/base/format.hpp"
#include "host/base/percentile.hpp"
#include "host/plan/forecast.hpp"
#include "host/plan/late_frames.hpp"
#include "host/plan/pick_samples.hpp"

namespace claray {
namespace {

/// Flat and Gouraud shading save no time.
bool is_cheaper(const Approximations& approximate) { return !approximate.flat && !approximate.gouraud; }

using Clock = std::chrono::steady_clock;

constexpr unsigned pilot_frames = 8;  // of which the slowest counts
constexpr double share = 0.85;        // of a frame's time that is planned for
constexpr unsigned most_spp = 1024;
constexpr double least_scale = 0.25;  // of the sides of images that are enlarged

/// A camera that turns round its target.
struct CameraPath {
    Camera first;
    double degrees = 0;
};

/// Frames of one renderer, each with a seed of its own.
class Frames {
public:
    /// Frames of `config`, enlarged to a picture of this size.
    Frames(const Device& device, const Scene& scene, const RenderConfig& config, glm::uvec2 picture,
           const CameraPath& path)
        : max_depth(config.max_depth),
          config_(config),
          picture_{.width = picture.x, .height = picture.y},
          path_(path),
          renderer_(device, scene, config),
          seed_(config.seed) {
        renderer_.settle();
    }

    /// Seconds for a frame, as seen from where the camera is after this share of its path.
    double next(double way = 0) {
        const Clock::time_point begin = Clock::now();
        if (path_.degrees != 0) {
            scene_.camera = orbited(path_.first, float(path_.degrees * way));
            renderer_.update(scene_, {.camera = true});
        }
        renderer_.restart(seed_++, spp, max_depth);
        (void)renderer_.render();
        (void)renderer_.picture(picture_);
        return std::chrono::duration<double>(Clock::now() - begin).count();
    }
    [[nodiscard]] std::vector<glm::vec3> image() const { return renderer_.image(picture_.width, picture_.height); }
    [[nodiscard]] const RenderConfig& config() const { return config_; }
    /// Traces images of this size.
    void resize(glm::uvec2 size) {
        if (size == glm::uvec2(config_.width, config_.height)) return;
        config_.width = size.x, config_.height = size.y;
        renderer_.resize(size.x, size.y);
    }
    /// Takes an eighth less of samples, or else of each side, but no less than this size.
    void lighten(glm::dvec2 least) {
        if (spp > 1)
            spp -= std::max(1u, spp / 8);
        else
            resize(
                glm::max(glm::uvec2(0.875 * glm::dvec2(config_.width, config_.height)), glm::uvec2(glm::ceil(least))));
    }
    /// The slowest of a few along the path, after one that may compile.
    double slowest() {
        (void)next();
        double most = 0;
        for (unsigned i = 0; i < pilot_frames; ++i) most = std::max(most, next(double(i) / (pilot_frames - 1)));
        return most;
    }

    unsigned spp = 1, max_depth;

private:
    RenderConfig config_;
    PictureConfig picture_;
    CameraPath path_;
    Renderer renderer_;
    Scene scene_;  // without objects, to carry the camera
    std::uint32_t seed_;
};

[[noreturn]] void refuse_rate(double budget, double seconds) {
    throw Error(
        ErrorKind::user,
        printed("%.4g frames per second cannot be reached: one sample per pixel takes %s even in the cheapest way",
                1 / budget, duration_text(seconds).c_str()),
        printed("the closest possible is about --fps %.3g; or use a smaller --size", share / seconds));
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

constexpr const char* complete_name = "complete";

/// A way to make frames.
struct Way {
    std::string name;
    std::shared_ptr<Frames> frames;
    glm::uvec2 size{0};
    unsigned max_depth = 0, spp = 1;
    double one = 0, seconds = 0;  // of a frame with one sample per pixel, and with those picked
    double error = 0;             // of such a frame, where ways compete
};

/// Measures the ways to make frames of a scene.
class Ways {
public:
    Ways(const Device& device, const Scene& scene, const RenderConfig& config, double budget, double degrees)
        : device_(device),
          scene_(scene),
          config_(config),
          budget_(budget),
          size_(config.width, config.height),
          path_{camera_of(scene, float(size_.x) / float(size_.y)), degrees} {}

    /// All pixels and the deepest paths.
    [[nodiscard]] Way complete() const { return way_of(complete_name, config_); }

    /// The best of those that are cheaper than `complete`.
    [[nodiscard]] Way cheaper(const Way& complete, const MeasuringProgress& measuring,
                              std::vector<std::string>& picks) const {
        const std::vector<glm::vec3> reference = reference_of(complete);
        std::vector<Way> ways = {shorter_paths(complete), smaller_image(complete)};
        if (!config_.approximate.any())
            for (const Approximations& approximate : approximations_for(scene_))
                if (is_cheaper(approximate) && (!measuring || measuring(to_string(approximate))))
                    ways.push_back(approximated(approximate));
        const Way* best = nullptr;
        for (Way& way : ways) {
            if (way.seconds > budget_) continue;
            take_samples(way);
            way.error = error_of(*way.frames, reference);
            picks.push_back(printed("%s: a frame of %s differs from the converged image by %.3g %%", way.name.c_str(),
                                    duration_text(way.seconds).c_str(), 100 * way.error));
            if (!best || way.error < best->error) best = &way;
        }
        if (best) return *best;
        double fastest = complete.seconds;
        for (const Way& way : ways) fastest = std::min(fastest, way.seconds);
        refuse_rate(budget_, fastest);
    }

    void take_samples(Way& way) const {
        use(way);
        way.one = way.seconds;
        const PickedSamples picked =
            pick_samples(way.one, std::min(config_.spp, most_spp), share * budget_, [&](unsigned spp) {
                way.frames->spp = spp;
                return slowest_of(*way.frames);
            });
        way.frames->spp = way.spp = picked.spp, way.seconds = picked.seconds;
    }

    /// Makes the frames those of this way, since ways may share a renderer.
    static void use(const Way& way) {
        way.frames->resize(way.size);
        way.frames->max_depth = way.max_depth, way.frames->spp = way.spp;
    }

private:
    [[nodiscard]] Way way_of(std::string name, const RenderConfig& config) const {
        Way way{std::move(name), std::make_shared<Frames>(device_, scene_, config, size_, path_), size_,
                config.max_depth};
        way.seconds = slowest_of(*way.frames);
        return way;
    }

    /// Seconds for a frame, to be compared with what is planned for.
    [[nodiscard]] double slowest_of(Frames& frames) const {
        return undelayed(share * budget_, [&] { return frames.slowest(); });
    }

    [[nodiscard]] Way shorter_paths(const Way& complete) const {
        Way way = complete;
        use(way);
        way.seconds = pick_depth(*way.frames, budget_);
        way.max_depth = way.frames->max_depth;
        way.name = printed("paths of at most %u surfaces", way.max_depth);
        return way;
    }

    /// The time of a frame falls nearly with its pixels.
    [[nodiscard]] Way smaller_image(const Way& whole) const {
        Way way = whole;
        for (double scale = std::sqrt(share * budget_ / whole.seconds); scale >= least_scale; scale *= 0.9) {
            way.size = glm::max(glm::uvec2(scale * glm::dvec2(size_)), 1u);
            use(way);
            way.seconds = way.frames->slowest();
            if (way.seconds <= share * budget_) break;
        }
        const std::string pixels = printed("%ux%u pixels, enlarged", way.size.x, way.size.y);
        way.name = way.name == complete_name ? pixels : way.name + ", " + pixels;
        return way;
    }

    /// In fewer pixels if need be.
    [[nodiscard]] Way approximated(const Approximations& approximate) const {
        RenderConfig config = config_;
        config.approximate = approximate;
        const Way way = way_of(to_string(approximate), config);
        return way.seconds <= share * budget_ ? way : smaller_image(way);
    }

    /// Of a second's samples.
    [[nodiscard]] std::vector<glm::vec3> reference_of(const Way& complete) const {
        use(complete);
        complete.frames->spp = std::clamp(unsigned(1 / complete.seconds), 4u, config_.spp < 4 ? 4u : config_.spp);
        (void)complete.frames->next();
        return complete.frames->image();
    }

    [[nodiscard]] double error_of(Frames& frames, const std::vector<glm::vec3>& reference) const {
        (void)frames.next();
        return image_error(frames.image(), reference, size_.x).rmse;
    }

    const Device& device_;
    const Scene& scene_;
    RenderConfig config_;
    double budget_;
    glm::uvec2 size_;
    CameraPath path_;
};

/// The most samples that fit, or a cheaper way.
Way pick(const Ways& ways, double budget, const MeasuringProgress& measuring, std::vector<std::string>& picks) {
    Way way = ways.complete();
    const double complete = way.seconds;
    if (way.seconds <= share * budget)
        ways.take_samples(way);
    else
        way = ways.cheaper(way, measuring, picks);
    Ways::use(way);
    picks.push_back(printed("samples: %u per pixel; one sample takes %s, a frame takes %s of %s", way.spp,
                            duration_text(way.one).c_str(), duration_text(way.seconds).c_str(),
                            duration_text(budget).c_str()));
    if (way.error > 0)
        picks.push_back(
            printed("chosen: %s, since one sample of all pixels takes %s; use a smaller --size to avoid this",
                    way.name.c_str(), duration_text(complete).c_str()));
    return way;
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
    plan.config.guide = false;     // frames of few samples learn too little
    plan.config.compiler.clear();  // frames wait for their kernels; a compiler beside them would delay some
    FramesReport report;
    if (measuring && (!measuring("kernels") || !measuring("samples that fit into a frame")))
        throw Error(ErrorKind::user, "interrupted before the first frame");
    const Way way = pick({device, scene, plan.config, budget, wanted.orbit}, budget, measuring, plan.picks);
    Frames& all = *way.frames;
    LateFrames late(budget);
    for (unsigned i = 1; i <= wanted.frames; ++i) {
        report.seconds.push_back(all.next(double(i) / wanted.frames));
        if (progress && !progress(i)) break;
        if (late.lighten_after(report.seconds.back()))
            all.lighten(least_scale * glm::dvec2(config.width, config.height));
    }
    report.picks = plan.picks;
    report.spp = all.spp, report.max_depth = all.max_depth;
    report.width = all.config().width, report.height = all.config().height;
    report.approximate = all.config().approximate, report.error = way.error;
    report.median = percentile(report.seconds, 0.5), report.percentile = percentile(report.seconds, 0.99);
    report.image = all.image();
    return report;
}

}  // namespace claray
