// Renders: takes samples in batches until a target is met, and starts again.
#include "claray/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "host/base/seconds_since.hpp"
#include "host/render/config/checks.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

/// The shortest last batch: half a percent of the time, but longer than a launch.
double least_milliseconds(double seconds) { return std::max(1.0, 5 * seconds); }

}  // namespace

ImageSizes Renderer::State::sizes(unsigned width, unsigned height) const {
    const unsigned film_width = config.image_width(), film_height = config.image_height();
    width = width == 0 ? film_width : width, height = height == 0 ? film_height : height;
    check_size(width, height);
    return {film_width, film_height, width, height};
}

void Renderer::State::look_through(const Camera& view) {
    wavefront.frame.camera = camera_data(view, aspect_of(config));
    source.camera = view;
}

ToneMapper& Renderer::State::mapper_of(std::uint32_t image_pixels) {
    if (!outputs.tone_mapper || outputs.tone_mapper->pixels() != image_pixels)
        outputs.tone_mapper.emplace(device, image_pixels);
    return *outputs.tone_mapper;
}

void Renderer::State::follow_light() {
    if (light_grid) light_grid->follow(source.camera.position, wavefront);
}

void Renderer::State::sample_all_pixels() {
    follow_light();
    InFlight in_flight(device, sampling.pace);
    while (spp() == 0) trace(sampling.schedule.next(sampling.pace.paths()), in_flight);
    device.finish();
}

AovStage& Renderer::State::aov_stage() {
    if (!outputs.aovs)
        outputs.aovs.emplace(buffers, wavefront.kernels.config.effects,
                             std::min<std::uint32_t>(wavefront.queues.capacity, pixels()), source.shape.uvs);
    return *outputs.aovs;
}

DenoisingStage& Renderer::State::denoising_stage() {
    if (!outputs.denoising) outputs.denoising.emplace(config);
    return *outputs.denoising;
}

void Renderer::State::discard_samples() {
    sampling.schedule = new_schedule();
    film.clear();
    if (outputs.matte) outputs.matte->clear();
    if (outputs.light_layers) outputs.light_layers->clear();
    if (sampling.guide) sampling.guide->forget();
    error.progress = {};
    time.begin.reset();
    if (outputs.denoising) outputs.denoising->start_film();
}

/// Drivers compile or load kernels when they first run, which does not count as time for samples.
void Renderer::State::warm_up() {
    const Batch few{0, std::min(pixels(), 64u), 0, 1, 0};
    Film scratch(device, few.pixels);
    const RayTotals::Counts counts = wavefront.totals.counts();
    wavefront.trace(few);
    scratch.accumulate(few, wavefront.queues.radiance);
    (void)scratch.noise();
    wavefront.totals.restore(counts);
}

/// Until the first of both limits is reached; infinite without one.
double Renderer::State::seconds_left() const {
    const double left = time.call_seconds - seconds_since(time.call_begin);
    return config.seconds > 0 ? std::min(left, config.seconds - seconds_since(*time.begin)) : left;
}

/// As many paths as fit in half of the time between two reports. Near a time limit, as fit in half of the remaining
/// time, because machines slow down without warning. Every pixel gets a sample in any case.
std::uint32_t Renderer::State::paths_of_next_batch(InFlight& in_flight) const {
    if (parts_take_turns()) return wavefront.queues.capacity;  // copying them takes as long for a few paths
    if (sampling.schedule.complete_passes_spp() == 0) return sampling.pace.paths();
    const double to_report = std::max(1.0, 1e3 * config.report_seconds / 2);
    const double limit = config.seconds > 0 ? std::min(config.seconds, time.call_seconds) : time.call_seconds;
    if (!std::isfinite(limit)) return sampling.pace.paths_within(to_report);
    const auto left = [&] { return 1e3 * seconds_left() - sampling.pace.milliseconds_of(in_flight.paths()); };
    const double least = least_milliseconds(limit);
    if (left() < least) in_flight.drain();  // the estimate may be too long
    return sampling.pace.paths_within(std::min(to_report, std::max(left() / 2, least)));
}

/// Aiming at hot spots needs the densities of directions without guiding.
bool Renderer::State::may_guide() const {
    return words_of_guide() > 0 && PathGuide::is_for(config) && config.spp > unguided_spp &&
           buffers.where.hot_spots == CLARAY_NO_TABLE && !source.bounds.empty();
}

std::string Renderer::why_unguided() const {
    const State& s = *state_;
    if (!s.config.guide || s.words_of_guide() == 0 || !PathGuide::is_for(s.config) || s.config.spp <= unguided_spp)
        return {};
    const auto has = [&](Effect kind) { return s.buffers.effects.has(kind); };
    if (!(has(Effect::lambert) || has(Effect::oren_nayar) || has(Effect::blinn_phong) || has(Effect::principled)))
        return "paths are not guided: no surface reflects diffusely";
    if (s.buffers.where.hot_spots != CLARAY_NO_TABLE) return "paths are not guided: some go to hot spots of lights";
    return {};
}

void Renderer::State::set_bounds(const Scene& scene, bool vertices) {
    if (!may_ever_guide()) return;
    if (vertices) source.mesh_bounds = bounds_of_meshes(scene);
    source.bounds = bounds_of(scene, source.mesh_bounds);
    sampling.guide.reset();
}

void Renderer::State::trace(const Batch& of_film) {
    const Batch batch = in_image(of_film);
    const auto add = [&](const Batch& part) {
        Batch in_film = part;
        in_film.listed = of_film.listed;
        if (outputs.matte) outputs.matte->take(part, in_film, wavefront);
        film.accumulate(in_film, wavefront.queues.radiance, buffers.tables, buffers.where.listed_pixels);
        if (outputs.light_layers)
            outputs.light_layers->accumulate(in_film, wavefront, buffers.tables, buffers.where.listed_pixels);
    };
    if (!may_guide()) {
        wavefront.trace(batch);
        return add(batch);
    }
    if (!sampling.guide) sampling.guide.emplace(device, source.bounds, config.width * config.height);
    if (has_region()) return sampling.guide->trace_region(batch, wavefront, add);
    sampling.guide->trace(batch, config.spp, wavefront, add);
}

void Renderer::State::trace(const Batch& batch, InFlight& in_flight) {
    trace(batch);
    in_flight.submitted(batch.pixels * batch.samples);
}

/// A full disk must not end a render of hours: writing is tried again, and the last failure is reported.
void Renderer::State::save_checkpoint() {
    const Checkpoint checkpoint{sampling.schedule.position(), error.progress, film.sums()};
    try {
        write_checkpoint(config.checkpoint, outputs.checkpoints.identity, checkpoint);
        outputs.checkpoints.error.clear();
    } catch (const Error& failure) {
        outputs.checkpoints.error = failure.what();
    }
}

void Renderer::State::refuse_with_checkpoints(const char* what) const {
    if (!config.checkpoint.empty()) throw Error(claray::ErrorKind::usage, what, "leave out the checkpoint");
}

RayCount Renderer::State::rays(const char* name, std::uint64_t count) const {
    return {count, std::max(0.0, device.profiler().milliseconds(name) - time.of_kernels.at(name))};
}

RenderProgress Renderer::render(const std::function<bool(const RenderProgress&)>& progress) {
    return render_for(std::numeric_limits<double>::infinity(), progress);
}

RenderProgress Renderer::render_for(double seconds, const std::function<bool(const RenderProgress&)>& progress) {
    if (std::isnan(seconds))
        throw Error(ErrorKind::usage, "the time to render is not a number", "give seconds, or infinity for no limit");
    State& state = *state_;
    const State::TimeOfCall time(state, seconds);
    if (!state.time.begin && state.config.seconds > 0) state.warm_up();
    state.follow_light();
    if (!state.time.begin) state.time.begin = Clock::now();
    if (state.time.first_begin == Clock::time_point()) state.time.first_begin = *state.time.begin;
    const bool saves = !state.config.checkpoint.empty();
    InFlight in_flight(state.device, state.sampling.pace);
    Clock::time_point last_report;  // the epoch, so that the first batch is reported at once
    Clock::time_point last_checkpoint = Clock::now();
    while (!state.target_met()) {
        if (state.better_waits_for_kernels())
            state.wait_for_kernels(in_flight);
        else
            state.trace(state.sampling.schedule.next(state.paths_of_next_batch(in_flight)), in_flight);
        state.choose_kernels(state.spp() > 0);
        if (saves && seconds_since(last_checkpoint) >= state.config.checkpoint_seconds) {
            state.save_checkpoint();
            last_checkpoint = Clock::now();
        }
        if (!progress || (!state.error.is_new && seconds_since(last_report) < state.config.report_seconds)) continue;
        state.error.is_new = false;
        if (!progress(state.measure())) break;
        last_report = Clock::now();
    }
    if (saves) state.save_checkpoint();
    state.device.finish();
    return state.measure();
}

void Renderer::restart(std::uint32_t seed, unsigned spp, unsigned max_depth) {
    State& state = *state_;
    state.refuse_with_checkpoints("a render that writes checkpoints cannot be restarted");
    state.config.seed = seed;
    state.wavefront.frame.seed = seed;
    const unsigned wanted = spp == 0 ? state.config.spp : std::min(spp, state.sampling.most_spp);
    if (wanted != state.config.spp) state.config.spp = wanted, state.kernels.of_paths.reset();
    if (max_depth != 0) state.wavefront.frame.max_depth = std::min(max_depth, state.config.max_depth);
    if (max_depth != 0) state.error.cut_off.reset();
    state.discard_samples();
}

void Renderer::State::extend(unsigned spp) {
    if (config.adaptive) throw Error(claray::ErrorKind::usage, "adaptive sampling cannot be extended", "restart it");
    config.spp = std::clamp(spp, config.spp, sampling.most_spp), kernels.of_paths.reset();
    sampling.schedule.extend(config.spp);
    time.begin.reset();
}

void Renderer::settle() {
    state_->settle();
    state_->buffers.structure.prepare_to_follow();
}

void Renderer::State::settle() {
    refuse_with_checkpoints("a render that writes checkpoints cannot discard samples");
    discard_samples();
    sample_all_pixels();
    if (time.first_pixel == 0) first_pixel();
    if (!kernels.are_own) take_over();
    use_path_kernel(0);
    for (int i = 0; i < 2; ++i) {  // drivers compile kernels again for the size of their groups
        discard_samples();
        sample_all_pixels();
        (void)film.noise();
    }
    discard_samples();
}

void Renderer::resize(unsigned width, unsigned height) {
    State& state = *state_;
    check_size(width, height);
    state.refuse_with_checkpoints("a render that writes checkpoints cannot change its size");
    state.refuse_with_region("a render of a region cannot change its size");
    if (state.config.adaptive)
        throw Error(ErrorKind::usage, "a render with adaptive sampling cannot change its size", "make a new renderer");
    if (width == state.config.width && height == state.config.height) return state.discard_samples();
    state.outputs.drop_views(), state.outputs.denoising.reset(),
        state.sampling.guide.reset();  // before more memory is taken
    state.config.width = width, state.config.height = height;
    state.wavefront.resize(width, height, std::uint64_t(state.pixels()) * state.sampling.most_spp);
    state.look_through(state.source.camera);
    state.film = Film(state.device, state.pixels(), state.config.sample_clamp);
    if (state.outputs.matte) state.outputs.matte->resize(width, height);
    if (state.outputs.light_layers) state.outputs.light_layers->resize(state.pixels());
    state.sampling.pace = Pace(state.first_paths(), state.wavefront.queues.capacity);
    state.kernels.of_paths.reset();
    state.error.cut_off.reset();
    state.discard_samples();
}

bool Renderer::rebuild(const Bvh::Config& config) {
    State& state = *state_;
    const Structure& structure = state.buffers.structure;
    if (structure.instanced() || structure.parts() || !state.kernels.are_own) return false;
    state.config.bvh = config;
    state.config.bvh.builder = resolve(config.builder, state.device);
    const KernelChoice& own = state.kernels.plan.last;
    state.adopt(structure.rebuilt(with_layout(config, own.layout)), own.effects);
    return true;
}

const std::string& Renderer::checkpoint_error() const { return state_->outputs.checkpoints.error; }

}  // namespace claray
