#include "claray/renderer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <optional>
#include <thread>

#include "claray/shared/spherical_harmonics.h"
#include "host/base/file.hpp"
#include "host/base/seconds_since.hpp"
#include "host/render/kernels/background_compiler.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned largest_side = 1u << 14;
constexpr double seconds_between_asking = 1;  // for a compiler while that of another render runs
constexpr std::size_t most_triangles_by_host = 1u << 20;
constexpr std::ptrdiff_t most_effects_to_optimize = 16;  // in quick kernels: PoCL takes two seconds to optimize these
constexpr std::uint32_t quick_first_paths = 2048;        // in the batch that produces the first pixel

double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

void check_size(unsigned width, unsigned height) {
    if (width == 0 || height == 0 || width > largest_side || height > largest_side)
        throw Error(ErrorKind::usage, "invalid image size " + std::to_string(width) + "x" + std::to_string(height),
                    "use 1 to 16384 pixels per side");
}

const RenderConfig& checked(const RenderConfig& config) {
    const auto refuse = [](const std::string& what, const char* remedy) {
        throw Error(ErrorKind::usage, what, remedy);
    };
    check_size(config.width, config.height);
    if (config.spp == 0) refuse("0 samples per pixel", "give at least 1");
    if (config.max_depth == 0) refuse("a maximum depth of 0", "give at least 1, which is direct light only");
    if (!(config.sample_clamp >= 0)) refuse("the limit of samples must not be negative or NaN", "use 0 for no limit");
    if (!(config.seconds >= 0 && std::isfinite(config.seconds)))
        refuse("the time limit must be finite and not negative", "give seconds, or 0 for no limit");
    if (!(config.noise >= 0)) refuse("the noise limit must not be negative or NaN", "start with 0.01");
    if (!(config.error >= 0 && std::isfinite(config.error)))
        refuse("the target error must be finite and not negative", "start with 0.01");
    if (!(config.report_seconds >= 0)) refuse("the time between reports must not be negative", "start with 0.2");
    const LightGridConfig& grid = config.light_grid;
    if (config.approximate.tile_sum && config.approximate.light_grid)
        refuse("the approximations tile-sum and light-grid exclude each other", "use one of them");
    if (config.adaptive && config.approximate.tile_sum)
        refuse("adaptive sampling and the approximation tile-sum exclude each other", "use one of them");
    if (config.approximate.flat && config.approximate.gouraud)
        refuse("the shading models flat and gouraud exclude each other", "use one of them");
    if (grid.side < 2 || grid.side > 64) refuse("the light grid has 2 to 64 probes per axis", "start with 16");
    if (grid.coefficients != 4 && grid.coefficients != CLARAY_HARMONICS)
        refuse("the light grid has 4 or 9 coefficients per colour", "use 9");
    if (grid.levels < 1 || grid.levels > 4) refuse("the light grid has 1 to 4 levels", "start with 1");
    if (grid.rays < 8 || grid.rays > 4096) refuse("a probe of the light grid traces 8 to 4096 rays", "start with 64");
    if (grid.updates < 1) refuse("the light grid needs at least one update", "start with 16");
    if (!(config.checkpoint_seconds > 0))
        refuse("the time between checkpoints must be greater than 0 seconds", "start with 30");
    return config;
}

const Scene& checked(const Scene& scene) {
    validate(scene);
    return scene;
}

RenderConfig with_builder(RenderConfig config, const Device& device, const Scene& scene) {
    config.bvh.builder = builder_for(config.bvh.builder, device, !scene.instances.empty());
    return config;
}

float aspect_of(const RenderConfig& config) { return float(config.width) / float(config.height); }

FrameData frame_data(const Scene& scene, const Camera& camera, const SceneBuffers& buffers,
                     const RenderConfig& config) {
    FrameData frame = frame_without_camera(scene, buffers, config);
    frame.camera = camera_data(camera, aspect_of(config));
    const auto& [reach, radiance] = config.ambient;
    frame.ambient = {radiance.r, radiance.g, radiance.b, reach};
    return frame;
}

/// Device time of everything but copies between host and device.
double kernel_milliseconds(const Device& device) {
    double total = 0;
    for (const auto& [name, summary] : device.profiler().summary())
        if (name != "write_buffer" && name != "read_buffer" && name != "map_buffer") total += summary.milliseconds;
    return total;
}

/// The shortest last batch: half a percent of the time, but longer than a launch.
double least_milliseconds(double seconds) { return std::max(1.0, 5 * seconds); }

std::ptrdiff_t number_of(EffectSet effects) {
    const std::span<const Effect> all = all_effects();
    return std::count_if(all.begin(), all.end(), [&](Effect effect) { return effects.has(effect); });
}

/// Returns whether the host can build the first tree in less time than compiling the builder takes.
bool host_builds(const Device& device, const Scene& scene) {
    std::size_t triangles = scene.instances.size();
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    return triangles <= most_triangles_by_host && (scene.instances.empty() || device.info().fp64);
}

/// A tree of trees is replaced only if the host built it, and trees in parts never. Quick kernels know no primitives.
KernelPlan plan_for(const Device& device, const Scene& scene, EffectSet effects, const RenderConfig& config,
                    unsigned parts) {
    KernelPlan plan = plan_kernels(device, effects, config);
    const bool replaceable = parts == 1 && (scene.instances.empty() || host_builds(device, scene));
    if (replaceable && scene.primitives.empty()) return plan;
    return {KernelStart::own, plan.last, plan.last};
}

/// A scene of one triangle cannot be split.
unsigned parts_of(const Device& device, const Scene& scene, const RenderConfig& config) {
    if (config.parts == 0) return parts_needed(device, scene, config.bvh);
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    return triangles > 1 ? config.parts : 1;
}

Structure first_structure(const Device& device, const Scene& scene, std::size_t baked, const KernelPlan& plan,
                          const Bvh::Config& config, unsigned parts) {
    const bool by_host =
        plan.start == KernelStart::quick && plan.first.layout == Layout::binary && host_builds(device, scene);
    return {device, scene, baked, with_layout(config, plan.first.layout), by_host, parts};
}

}  // namespace

LightSelection selection_of_lights(const RenderConfig& config) {
    LightSelection selection;
    if (config.approximate.tile_sum) selection.for_a_tree = std::numeric_limits<std::size_t>::max();
    if (config.approximate.tile_sum || config.effects.remove.has(Effect::light_lists)) selection.most_per_cell = 0;
    selection.compensates = !config.approximate.no_shadows;
    selection.hot_spots = !config.approximate.tile_sum && !config.approximate.light_grid;
    return selection;
}

std::optional<LightGridStage> light_grid_of(const RenderConfig& config, const Scene& scene) {
    if (!config.approximate.light_grid) return std::nullopt;
    return LightGridStage(config.light_grid, bounds_of(scene));
}

Bvh::Config with_layout(Bvh::Config config, Layout layout) {
    config.layout = layout;
    return config;
}

Renderer::State::State(const Device& on, const Scene& scene, const RenderConfig& with, std::size_t baked,
                       std::optional<EffectSet> exactly)
    : device(on),
      config(with_builder(checked(with), on, scene)),
      camera(camera_of(scene, aspect_of(with))),
      set_up(Clock::now()),
      parts(parts_of(on, checked(scene), config)),
      plan(plan_for(on, scene, exactly ? *exactly : effects_of(scene), config, parts)),
      quick_start(plan.start == KernelStart::quick ? std::make_unique<QuickStart>(on) : nullptr),
      set_up_processor(processor_seconds()),
      milliseconds_before(kernel_milliseconds(on)),
      structure(first_structure(on, scene, baked, plan, config.bvh, parts)),
      build_milliseconds(kernel_milliseconds(on) - milliseconds_before),
      light_grid(light_grid_of(with, scene)),
      buffers(on, scene, structure, config.effects.add, selection_of_lights(with), words_of(light_grid),
              words_of_listed_pixels(), words_of_guide()),
      wavefront(on, buffers, frame_data(scene, camera, buffers, with), load_kernels(plan.first.effects),
                std::uint64_t(pixels()) * with.spp),
      film(on, pixels(), tells_error(with), with.sample_clamp),
      schedule(new_schedule()),
      pace(first_paths(), wavefront.capacity()) {
    for (const char* name : {trace_camera_name, trace_bounce_name, trace_shadow_name, trace_paths_name})
        before[name] = device.profiler().milliseconds(name);
}

WavefrontKernels Renderer::State::load_kernels(EffectSet effects) const {
    const PathTask task = path_task_of(config.approximate);
    const auto load = [&] { return WavefrontKernels(buffers, config.sampler, effects, task, config.approximate); };
    const auto load_all = [&] {
        (void)load();
        (void)Film::Kernels(device);
        if (words_of_guide() > 0) PathGuide::load_kernels(device);
    };
    if (!own_kernels && plan.start == KernelStart::quick)
        compile_jointly(device, load_all, number_of(effects) <= most_effects_to_optimize);
    else
        compile_side_by_side(device, load_all);
    if (words_of_guide() > 0) PathGuide::load_kernels(device);
    return load();
}

bool Renderer::State::parts_take_turns() const { return structure.parts() && structure.parts()->take_turns(); }

std::uint32_t Renderer::State::first_paths() const {
    if (parts_take_turns()) return wavefront.capacity();
    const std::uint32_t tuned = device.tuning("render/wavefront", "FIRST_PATHS");
    return plan.start == KernelStart::quick ? std::min(tuned, quick_first_paths) : tuned;
}

/// Waits for the first pixel. Later work is not urgent.
void Renderer::State::first_pixel() {
    device.finish();
    first_pixel_seconds = seconds_since(set_up);
    first_pixel_processor_seconds = processor_seconds() - set_up_processor;
    culled = structure.culled();
    quick_start.reset();
    own_kernels = plan.first == plan.last;
    if (own_kernels)
        remember_as_cached(device, plan.last, config);
    else
        compiler_asked = start_compiler(config.compiler, device, plan.last, config), last_asked = Clock::now();
}

/// Between two batches, so that no path uses two kinds of kernels, although the image would be the same.
void Renderer::State::take_over_when_compiled() {
    if (!are_cached(device, plan.last, config)) {
        if (compiler_asked || seconds_since(last_asked) < seconds_between_asking) return;
        compiler_asked = start_compiler(config.compiler, device, plan.last, config), last_asked = Clock::now();
        return;
    }
    take_over();
}

/// On a CPU quick kernels leave the compiler a tenth of a processor, and take several times as long as the kernels that
/// it makes. These compile in 1.5 to 7 times the processor time of a first pixel by quick kernels (seven scenes, PoCL
/// 3.1). Whatever happens to the compiler, waiting at most doubles the time.
bool Renderer::State::better_waits_for_kernels() const {
    constexpr double compiling_over_first_pixel = 5, seconds_to_tell = 1;  // the first batches vary
    if (own_kernels || spp() == 0 || device.info().type != DeviceType::cpu) return false;
    if (compiler_asked && !is_compiling()) return false;  // it has failed
    const std::uint64_t paths_left = std::uint64_t(pixels()) * (config.spp - spp());
    const double left = std::min(seconds_left(), 1e-3 * pace.milliseconds_of(paths_left));
    const double seconds = seconds_since(set_up) - first_pixel_seconds;
    return seconds > seconds_to_tell && seconds < left &&
           left > compiling_over_first_pixel * first_pixel_processor_seconds;
}

void Renderer::State::take_over() {
    own_kernels = true;
    own_kernels_from = spp();
    const bool rebuilds = plan.last.layout != plan.first.layout;
    adopt(rebuilds ? structure.rebuilt(with_layout(config.bvh, plan.last.layout)) : structure, plan.last.effects);
}

void Renderer::State::choose_kernels(bool sampled) {
    if (first_pixel_seconds == 0) first_pixel();
    if (!own_kernels) take_over_when_compiled();
    if (own_kernels && sampled) use_path_kernel(patience);
}

/// The largest pass, half of the samples, takes most of the time.
bool Renderer::State::may_follow_paths() const {
    const std::uint64_t largest_pass = std::uint64_t(pixels()) * std::max(1u, config.spp / 2);
    return wavefront.batches_are_small(largest_pass) && claray::may_follow_paths(buffers, plan.last.effects);
}

PathKernelChoice Renderer::State::choose_path_kernel() const {
    PathKernelChoice choice;
    const Approximations& a = config.approximate;
    if (a.tile_sum || a.flat || a.gouraud || a.no_shadows)
        choice.name = "";
    else if (may_follow_paths() && wavefront.paths_are_short())
        choice.name = trace_paths_name;
    else if (may_finish_paths(buffers, plan.last.effects))
        choice.name = finish_paths_name;
    choice.is_cached = choice.name.empty() || is_path_kernel_cached(device, plan.last, config, choice.name);
    return choice;
}

/// Loading the kernel takes as long as a short render, and compiling it longer; so it waits until rendering took as
/// long, which at worst doubles the time.
void Renderer::State::use_path_kernel(double patience) {
    const double seconds = seconds_since(first_begin);
    if (seconds >= patience / 16) adopt_path_kernel(seconds >= patience);
}

/// Decides once, when every pixel was sampled by the scene's own kernels, whether one kernel traces whole paths from
/// then on, or the last ones of each batch.
void Renderer::State::adopt_path_kernel(bool may_compile) {
    if (path_kernel && path_kernel->is_loaded) return;
    if (!path_kernel) path_kernel = choose_path_kernel();
    if (!path_kernel->is_cached && !may_compile) return;
    path_kernel->is_loaded = true;
    if (path_kernel->name.empty()) return;
    Kernel kernel = load_path_kernel(buffers, config.sampler, plan.last.effects, path_kernel->name,
                                     path_task_of(config.approximate));
    path_kernel->name == trace_paths_name ? wavefront.follow_paths(kernel) : wavefront.finish_paths(kernel);
    remember_path_kernel_as_cached(device, plan.last, config, path_kernel->name);
}

void Renderer::State::adopt(const Structure& other, EffectSet effects) {
    structure = other;
    structure.set_cutouts(buffers.textures.cutouts());
    buffers.structure = structure;
    wavefront.take_over(structure, load_kernels(effects));
    path_kernel.reset();
    aovs.reset(), gbuffer.reset();
    if (denoising) denoising->drop_guides();
    film.reload_kernels();
}

ImageSizes Renderer::State::sizes(unsigned width, unsigned height) const {
    width = width == 0 ? config.width : width, height = height == 0 ? config.height : height;
    check_size(width, height);
    return {config.width, config.height, width, height};
}

void Renderer::State::look_through(const Camera& view) {
    wavefront.set_camera(camera_data(view, aspect_of(config)));
    camera = view;
}

ToneMapper& Renderer::State::mapper_of(std::uint32_t image_pixels) {
    if (!tone_mapper || tone_mapper->pixels() != image_pixels) tone_mapper.emplace(device, image_pixels);
    return *tone_mapper;
}

void Renderer::State::follow_light() {
    if (light_grid) light_grid->follow(camera.position, wavefront, buffers);
}

void Renderer::State::sample_all_pixels() {
    follow_light();
    InFlight in_flight(device, pace);
    while (spp() == 0) trace(schedule.next(pace.paths()), in_flight);
    device.finish();
}

AovStage& Renderer::State::aov_stage() {
    if (!aovs)
        aovs.emplace(buffers, wavefront.kernel_effects(), std::min<std::uint32_t>(wavefront.capacity(), pixels()));
    return *aovs;
}

DenoisingStage& Renderer::State::denoising_stage() {
    if (!denoising) denoising.emplace(config);
    return *denoising;
}

void Renderer::State::discard_samples() {
    schedule = new_schedule();
    film.clear();
    if (guide) guide->forget();
    looks = {}, last_error = {}, last_error_spp = 0;
    begin.reset();
    if (denoising) denoising->start_film();
}

/// Drivers compile or load kernels when they first run, which does not count as time for samples.
void Renderer::State::warm_up() {
    const Batch few{0, std::min(pixels(), 64u), 0, 1, 0};
    Film scratch(device, few.pixels);
    wavefront.trace(few);
    scratch.accumulate(few, wavefront.radiance());
    (void)scratch.noise();
    wavefront.reset_totals();
}

/// Until the first of both limits is reached; infinite without one.
double Renderer::State::seconds_left() const {
    const double left = call_seconds - seconds_since(call_begin);
    return config.seconds > 0 ? std::min(left, config.seconds - seconds_since(*begin)) : left;
}

/// As many paths as fit in half of the time between two reports. Near a time limit, as fit in half of the remaining
/// time, because machines slow down without warning. Every pixel gets a sample in any case.
std::uint32_t Renderer::State::paths_of_next_batch(InFlight& in_flight) const {
    if (parts_take_turns()) return wavefront.capacity();  // copying them takes as long for a few paths
    if (schedule.complete_passes_spp() == 0) return pace.paths();
    const double to_report = std::max(1.0, 1e3 * config.report_seconds / 2);
    const double limit = config.seconds > 0 ? std::min(config.seconds, call_seconds) : call_seconds;
    if (!std::isfinite(limit)) return pace.paths_within(to_report);
    const auto left = [&] { return 1e3 * seconds_left() - pace.milliseconds_of(in_flight.paths()); };
    const double least = least_milliseconds(limit);
    if (left() < least) in_flight.drain();  // the estimate may be too long
    return pace.paths_within(std::min(to_report, std::max(left() / 2, least)));
}

/// Aiming at hot spots needs the densities of directions without guiding.
bool Renderer::State::may_guide() const {
    return words_of_guide() > 0 && PathGuide::is_for(config) && config.spp > unguided_spp &&
           buffers.where.hot_spots == CLARAY_NO_TABLE && !bounds.empty();
}

void Renderer::State::set_bounds(const Scene& scene, bool vertices) {
    if (!may_ever_guide()) return;
    if (vertices) mesh_bounds = bounds_of_meshes(scene);
    bounds = bounds_of(scene, mesh_bounds);
    guide.reset();
}

void Renderer::State::trace(const Batch& batch) {
    const auto add = [&](const Batch& part) {
        film.accumulate(part, wavefront.radiance(), buffers.tables, buffers.where.listed_pixels);
    };
    if (!may_guide()) {
        wavefront.trace(batch);
        return add(batch);
    }
    if (!guide) guide.emplace(device, bounds, pixels());
    guide->trace(batch, config.spp, wavefront, buffers, add);
}

void Renderer::State::trace(const Batch& batch, InFlight& in_flight) {
    trace(batch);
    in_flight.submitted(batch.pixels * batch.samples);
}

/// A full disk must not end a render of hours: writing is tried again, and the last failure is reported.
void Renderer::State::save_checkpoint() {
    const Checkpoint checkpoint{schedule.position(), looks, film.sums()};
    try {
        write_checkpoint(config.checkpoint, identity, checkpoint);
        checkpoint_error.clear();
    } catch (const Error& error) {
        checkpoint_error = error.what();
    }
}

void Renderer::State::refuse_with_checkpoints(const char* what) const {
    if (!config.checkpoint.empty()) throw Error(claray::ErrorKind::usage, what, "leave out the checkpoint");
}

RayCount Renderer::State::rays(const char* name, std::uint64_t count) const {
    return {count, std::max(0.0, device.profiler().milliseconds(name) - before.at(name))};
}

Renderer::Renderer(const Device& device, const Scene& scene, const RenderConfig& config) {
    const auto state_of = [&](const Scene& wanted) {
        if (wanted.instances.empty()) {
            auto state = std::make_shared<State>(device, wanted, config);
            state->shape = SceneShape(wanted, wanted, {}, {});
            return state;
        }
        PlacedScene placed = place_instances(checked(wanted));
        auto state = std::make_shared<State>(device, placed.scene, config, placed.baked);
        state->shape = SceneShape(wanted, placed.scene, std::move(placed.places), std::move(placed.numbers));
        return state;
    };
    RenderIdentity identity;
    std::optional<Checkpoint> from;  // read before the structure is built
    const bool resumes = !config.resume.empty(), saves = !config.checkpoint.empty();
    if (resumes || saves) identity = identity_of(checked(scene), checked(config));
    if (resumes) from = read_checkpoint(config.resume, identity, config.spp);
    if (saves) check_file_writable(config.checkpoint);
    state_ = config.effects.remove.empty() ? state_of(scene) : state_of(without_effects(scene, config.effects.remove));
    state_->set_bounds(scene, true);
    state_->identity = identity;
    if (!from) return;
    if (!state_->schedule.go_to(from->position))
        throw Error(ErrorKind::user,
                    "cannot continue from '" + config.resume.string() +
                        "': the file is damaged: its position is outside the image",
                    "render from the start");
    state_->list_pixels();
    state_->looks = from->looks;
    state_->film.set_sums(from->sums);
}

RenderProgress Renderer::render(const std::function<bool(const RenderProgress&)>& progress) {
    return render_for(std::numeric_limits<double>::infinity(), progress);
}

RenderProgress Renderer::render_for(double seconds, const std::function<bool(const RenderProgress&)>& progress) {
    if (std::isnan(seconds))
        throw Error(ErrorKind::usage, "the time to render is not a number", "give seconds, or infinity for no limit");
    State& state = *state_;
    const State::TimeOfCall time(state, seconds);
    if (!state.begin && state.config.seconds > 0) state.warm_up();
    state.follow_light();
    if (!state.begin) state.begin = Clock::now();
    if (state.first_begin == Clock::time_point()) state.first_begin = *state.begin;
    const bool saves = !state.config.checkpoint.empty();
    InFlight in_flight(state.device, state.pace);
    Clock::time_point last_report;  // the epoch, so that the first batch is reported at once
    Clock::time_point last_checkpoint = Clock::now();
    while (!state.target_met()) {
        if (state.better_waits_for_kernels())
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        else
            state.trace(state.schedule.next(state.paths_of_next_batch(in_flight)), in_flight);
        state.choose_kernels(state.spp() > 0);
        if (saves && seconds_since(last_checkpoint) >= state.config.checkpoint_seconds) {
            state.save_checkpoint();
            last_checkpoint = Clock::now();
        }
        if (!progress || (!state.error_is_new && seconds_since(last_report) < state.config.report_seconds)) continue;
        state.error_is_new = false;
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
    state.wavefront.set_seed(seed);
    const unsigned wanted = spp == 0 ? state.config.spp : std::min(spp, state.most_spp);
    if (wanted != state.config.spp) state.config.spp = wanted, state.path_kernel.reset();
    if (max_depth != 0) state.wavefront.set_max_depth(std::min(max_depth, state.config.max_depth));
    if (max_depth != 0) state.light_cut_off.reset();
    state.discard_samples();
}

void Renderer::State::extend(unsigned spp) {
    if (config.adaptive) throw Error(claray::ErrorKind::usage, "adaptive sampling cannot be extended", "restart it");
    config.spp = std::clamp(spp, config.spp, most_spp), path_kernel.reset();
    schedule.extend(config.spp);
    begin.reset();
}

void Renderer::settle() {
    state_->settle();
    state_->structure.prepare_to_follow();
}

void Renderer::load_kernels() {
    State& state = *state_;
    if (state.first_pixel_seconds == 0 || state.spp() == 0) return;
    if (!state.own_kernels) state.take_over_when_compiled();
    if (!state.own_kernels) return;
    state.adopt_path_kernel(true);
    state.warm_up();
}

void Renderer::State::settle() {
    refuse_with_checkpoints("a render that writes checkpoints cannot discard samples");
    discard_samples();
    sample_all_pixels();
    if (first_pixel_seconds == 0) first_pixel();
    if (!own_kernels) take_over();
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
    if (state.config.adaptive)
        throw Error(ErrorKind::usage, "a render with adaptive sampling cannot change its size", "make a new renderer");
    if (width == state.config.width && height == state.config.height) return state.discard_samples();
    state.aovs.reset(), state.gbuffer.reset(), state.denoising.reset(),
        state.guide.reset();  // before more memory is taken
    state.config.width = width, state.config.height = height;
    state.wavefront.resize(width, height, std::uint64_t(state.pixels()) * state.most_spp);
    state.look_through(state.camera);
    state.film = Film(state.device, state.pixels(), tells_error(state.config), state.config.sample_clamp);
    state.pace = Pace(state.first_paths(), state.wavefront.capacity());
    state.path_kernel.reset();
    state.light_cut_off.reset();
    state.discard_samples();
}

bool Renderer::rebuild(const Bvh::Config& config) {
    State& state = *state_;
    if (state.structure.instanced() || state.structure.parts() || !state.own_kernels) return false;
    state.config.bvh = config;
    state.config.bvh.builder = resolve(config.builder, state.device);
    state.adopt(state.structure.rebuilt(with_layout(config, state.plan.last.layout)), state.plan.last.effects);
    return true;
}

const std::string& Renderer::checkpoint_error() const { return state_->checkpoint_error; }

void compile_kernels(const Device& device, EffectSet effects, const RenderConfig& with) {
    RenderConfig config = with;
    // With $POCL_WORK_GROUP_SPECIALIZATION=1 PoCL compiles a kernel once for grids of at least 2^16 items and once for
    // smaller ones: the first bounce of these paths is of the first kind, the others are of the second.
    config.width = config.height = 256, config.spp = 1, config.max_depth = 3;
    config.compiler.clear();
    const KernelChoice choice = plan_kernels(device, effects, config).last;
    compile_once(device, choice, config, [&] {
        Renderer::State state(device, scene_calling_for(effects), config, 0, effects);
        state.follow_light();
        const Batch batch = state.schedule.next();
        state.wavefront.trace(batch);
        state.film.accumulate(batch, state.wavefront.radiance());
        (void)state.film.image();
        (void)state.structure.statistics();
        remember_as_cached(device, choice, config);
    });
}

}  // namespace claray
