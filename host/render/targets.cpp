// The targets of a render: when it has enough samples, and what its progress tells of the error.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "host/base/seconds_since.hpp"
#include "host/render/renderer_state.hpp"
#include "host/render/wavefront/cut_off.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned least_spp_for_noise = 16;
constexpr unsigned spp_that_see_light = 2048;
/// The halves of the Sobol samples tell 1 to 1.6 times the error, the more the better their points are spread
/// (docs/accuracy.md). This is about the middle, for figures that are told; bounds do without it.
constexpr double pessimism_of_halves = 1.1;

}  // namespace

/// Measures the time without that of batches that are still running. The work is enqueued after them anyway, so that
/// the device does not wait for the host.
template <class Measure>
auto Renderer::State::timed(const Measure& measure) {
    const Mark batches(device);
    film.look();
    batches.wait();
    const Clock::time_point before_it = Clock::now();
    const auto measured = measure();
    error.measuring_seconds += seconds_since(before_it);
    return measured;
}

RenderProgress Renderer::State::measure() {
    RenderProgress progress;
    progress.spp = spp();
    progress.spp_target = config.spp;
    const Film::Noise noise = timed([&] { return film.noise(); });
    progress.noise = noise.relative * noise_over_halves();
    const ErrorProgress& told = error.progress;
    progress.cut_off = error.cut_off.value_or(0);
    if (told.last.square > 0) {
        progress.error = std::hypot(std::sqrt(told.last.square), progress.cut_off);
        progress.error_bound = std::hypot(std::sqrt(told.bound()), progress.cut_off);
        progress.error_of_fireflies = told.last.fireflies;
    }
    progress.error_spp = told.spp;
    progress.own_kernels = kernels.are_own;
    progress.waits_for_kernels = kernels.compiler.is_waited_for;
    progress.dropped_samples = noise.dropped;
    progress.culled = source.culled;
    progress.seconds = time.begin ? seconds_since(*time.begin) : 0;
    return progress;
}

bool Renderer::State::target_met() {
    if (limit_reached()) return true;
    plan_round();
    return sampling.schedule.finished();
}

/// Noise is tested only between passes, so that the stopping point does not depend on time.
bool Renderer::State::limit_reached() {
    if (sampling.schedule.finished()) return true;
    const unsigned spp = sampling.schedule.complete_passes_spp();
    if (spp > 0 && seconds_left() <= 0) return true;
    if (!sampling.schedule.between_passes()) return false;
    if (config.error > 0 && error_met()) return true;
    if (!(config.noise > 0) || spp < least_spp_for_noise) return false;
    const double noise = timed([&] { return film.noise(); }).relative * noise_over_halves();
    return noise > 0 && noise <= config.noise;
}

/// Plans the next round of adaptive sampling, if one is due.
void Renderer::State::plan_round() {
    if (!sampling.schedule.wants_plan()) return;
    sampling.schedule.plan(timed([&] { return film.gain_per_sample(config.image_width()); }));
    list_pixels();
}

void Renderer::State::list_pixels() const {
    const AdaptiveSchedule::Round& round = sampling.schedule.round();
    if (sampling.schedule.in_round()) buffers.list_pixels(round.halves, round.unit, config.width, config.height);
}

/// Called between passes; the next pass ends no later than the next look.
bool Renderer::State::error_met() {
    const unsigned spp = sampling.schedule.complete_passes_spp();
    const double noise = error_left_to_noise();
    if (spp >= error.progress.next(noise)) look_at_error(spp);
    const std::uint32_t next = error.progress.next(noise);
    if (error.progress.spp == spp && next == spp) return true;
    if (next > spp) sampling.schedule.limit_pass(next - spp);
    return false;
}

void Renderer::State::look_at_error(unsigned spp) {
    if (error.progress.spp == spp) return;
    error.is_new = true;
    const ErrorEstimate found = timed([&] {
        const ErrorLook look = look_at_controls();
        return estimate_error(look.image, look.variances, look.expected, error.progress.controls);
    });
    error.progress.add(found, spp);
    if (error.progress.last.square > 0 || spp < spp_that_see_light) return;
    throw Error(claray::ErrorKind::user,
                "the image is black after " + std::to_string(spp) +
                    " samples per pixel: an error relative to its mean is undefined",
                "add light, or use --spp instead of --error");
}

double Renderer::State::noise_over_halves() const {
    return config.sampler == Sampler::sobol ? 1 / pessimism_of_halves : 1;
}

/// Does not depend on the samples or the seed.
double Renderer::State::cut_off() {
    if (!error.cut_off) error.cut_off = timed([&] { return share_cut_off(wavefront); });
    return *error.cut_off;
}

/// Cut-off light is missing from every pixel: if it alone reaches the error target, no noise is allowed.
double Renderer::State::error_left_to_noise() {
    if (spp() == 0) return config.error;
    const double share = cut_off();
    if (share < config.error) return std::sqrt(config.error * config.error - share * share);
    char text[160];
    std::snprintf(
        text, sizeof text,
        "an error of %.3g cannot be reached: about %.2g of the light is missing, since paths end after %u surfaces",
        config.error, share, config.max_depth);
    throw Error(claray::ErrorKind::user, text, "use a larger --max-depth, or leave it out");
}

}  // namespace claray
