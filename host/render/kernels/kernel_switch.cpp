// Loads the kernels with which a render begins, switches to its own kernels once they are compiled (kernel_choice.hpp),
// and compiles kernels in advance.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>

#include "host/base/seconds_since.hpp"
#include "host/render/kernels/background_compiler.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double seconds_between_asking = 1;          // for a compiler while that of another render runs
constexpr std::size_t most_effects_to_optimize = 16;  // in quick kernels: PoCL takes two seconds to optimize these

}  // namespace

WavefrontKernels Renderer::State::load_kernels(EffectSet effects) const {
    const StageConfig config_of_stages = stages(effects);
    const KernelSet set = programs_of_stages(device, config_of_stages);
    if (!kernels.are_own && kernels.plan.start == KernelStart::quick)
        load_jointly(device, set, number_of(effects) <= most_effects_to_optimize);
    else
        load(device, set);
    return {buffers, config_of_stages};
}

SceneTraits Renderer::State::traits(EffectSet effects) const {
    return {.effects = effects,
            .culls_back_faces = buffers.textures.culls_back_faces,
            .primitives = buffers.structure.format().primitives,
            .is_split = buffers.structure.parts() != nullptr,
            .shaders = buffers.shaders};
}

/// Waits for the first pixel. Later work is not urgent.
void Renderer::State::first_pixel() {
    device.finish();
    time.first_pixel = seconds_since(time.set_up);
    time.first_pixel_processor = processor_seconds() - time.set_up_processor;
    source.culled = buffers.structure.culled();
    kernels.are_own = kernels.plan.first == kernels.plan.last;
    if (!kernels.are_own) ask_for_compiler();
}

void Renderer::State::ask_for_compiler() {
    KernelSet later;
    later.add(device, area_sum);
    later.add(generic_kernels(device, {.effects = full_effects()}, config).programs);
    kernels.compiler.is_asked = start_compiler(config.compiler, device, kernels.plan.last.programs, later);
    kernels.compiler.last_asked = Clock::now();
}

/// Between two batches, so that no path uses two kinds of kernels, although the image would be the same.
void Renderer::State::take_over_when_compiled() {
    if (!are_cached(device, kernels.plan.last.programs)) {
        if (!kernels.compiler.is_asked && seconds_since(kernels.compiler.last_asked) >= seconds_between_asking)
            ask_for_compiler();
        return;
    }
    take_over();
}

/// On a CPU quick kernels leave the compiler a tenth of a processor, and take several times as long as the kernels that
/// it makes. These compile in 1.5 to 7 times the processor time of a first pixel by quick kernels (seven scenes, PoCL
/// 3.1). Generic kernels take twice as long at most: they do not wait. Nor does a render whose kernels another process
/// will compile only later. Where other processes leave this one less than a processor, the rest takes longer, but no
/// more of the processor's time. Whatever happens to the compiler, waiting at most doubles the time.
bool Renderer::State::better_waits_for_kernels() {
    constexpr double compiling_over_first_pixel = 5, seconds_to_tell = 1;  // the first batches vary
    kernels.compiler.is_waited_for = false;
    if (kernels.are_own || spp() == 0 || kernels.plan.start != KernelStart::quick ||
        device.info().type != DeviceType::cpu)
        return false;
    if (!kernels.compiler.is_asked || !is_compiling()) return false;  // another render's compiles, or it has failed
    const std::uint64_t paths_left = std::uint64_t(pixels()) * (config.spp - spp());
    const double left = std::min(seconds_left(), 1e-3 * sampling.pace.milliseconds_of(paths_left));
    const double sampled_for = seconds_since(time.set_up) - time.first_pixel - kernels.compiler.waited;
    const double used = processor_seconds() - time.set_up_processor - time.first_pixel_processor;
    const double of_processor = left * std::min(1.0, used / std::max(sampled_for, 1e-3));
    kernels.compiler.is_waited_for = sampled_for > seconds_to_tell && kernels.compiler.waited < left &&
                                     of_processor > compiling_over_first_pixel * time.first_pixel_processor;
    return kernels.compiler.is_waited_for;
}

void Renderer::State::wait_for_kernels(InFlight& in_flight) {
    in_flight.pause();
    const Clock::time_point begin = Clock::now();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    kernels.compiler.waited += seconds_since(begin);
}

void Renderer::State::take_over() {
    kernels.are_own = true;
    kernels.compiler.is_waited_for = false;
    kernels.own_from = spp();
    const KernelChoice& own = kernels.plan.last;
    const bool rebuilds = own.layout != kernels.plan.first.layout;
    const Structure& structure = buffers.structure;
    adopt(rebuilds ? structure.rebuilt(with_layout(config.bvh, own.layout)) : structure, own.effects);
}

void Renderer::State::choose_kernels(bool sampled) {
    if (time.first_pixel == 0) first_pixel();
    if (!kernels.are_own) take_over_when_compiled();
    if (kernels.are_own && sampled) use_path_kernel(kernels.patience);
}

/// The largest pass, half of the samples, takes most of the time.
bool Renderer::State::may_follow_paths() const {
    const std::uint64_t largest_pass = std::uint64_t(pixels()) * std::max(1u, config.spp / 2);
    return wavefront.path_kernels.is_small(std::min<std::uint64_t>(largest_pass, wavefront.queues.capacity)) &&
           claray::may_follow_paths(buffers, kernels.plan.last.effects);
}

PathKernelChoice Renderer::State::choose_path_kernel() const {
    const Approximations& a = config.approximate;
    const bool follows = may_follow_paths() && paths_are_short(device, wavefront.totals.sums());
    if (a.tile_sum || a.flat || a.gouraud || a.no_shadows || light_layers_of(config) > 0) return {};
    if (!follows && !may_finish_paths(buffers, kernels.plan.last.effects)) return {};
    PathKernelChoice choice;
    choice.kernel =
        kernel_of_paths(device, stages(kernels.plan.last.effects), follows ? trace_paths_name : finish_paths_name);
    choice.program.add(device, choice.kernel);
    choice.is_cached = are_cached(device, choice.program);
    return choice;
}

/// Loading the kernel takes as long as a short render, and compiling it longer; so it waits until rendering took as
/// long, which at worst doubles the time.
void Renderer::State::use_path_kernel(double patience) {
    const double seconds = seconds_since(time.first_begin);
    if (seconds >= patience / 16) adopt_path_kernel(seconds >= patience);
}

/// Decides once, when every pixel was sampled by the scene's own kernels, whether one kernel traces whole paths from
/// then on, or the last ones of each batch.
void Renderer::State::adopt_path_kernel(bool may_compile) {
    if (kernels.of_paths && kernels.of_paths->is_loaded) return;
    if (!kernels.of_paths) kernels.of_paths = choose_path_kernel();
    if (!kernels.of_paths->is_cached && !may_compile) return;
    kernels.of_paths->is_loaded = true;
    if (kernels.of_paths->program.programs().empty()) return;
    load(device, kernels.of_paths->program);
    wavefront.path_kernels.add(load_kernel(device, kernels.of_paths->kernel));
}

void Renderer::State::adopt(const Structure& other, EffectSet effects) {
    buffers.structure = other;
    buffers.structure.set_cutouts(buffers.textures.cutouts());
    wavefront.take_over(buffers.structure, load_kernels(effects));
    kernels.of_paths.reset();
    outputs.drop_views();
    if (outputs.denoising) outputs.denoising->drop_guides();
    film.reload_kernels();
    forget_slow_programs(device);
}

void Renderer::load_kernels() {
    State& state = *state_;
    if (state.time.first_pixel == 0 || state.spp() == 0) return;
    if (!state.kernels.are_own) state.take_over_when_compiled();
    if (!state.kernels.are_own) return;
    state.adopt_path_kernel(true);
    state.warm_up();
}

void compile_kernels(const Device& device, EffectSet effects, const RenderConfig& config) {
    const bool has_primitives = effects.has(Effect::primitives);
    KernelSet set =
        scene_kernels(device, {.effects = effects, .primitives = has_primitives ? 1u << CLARAY_SPHERES : 0u}, config)
            .programs;
    set.add(device, area_sum);
    load(device, set);
}

}  // namespace claray
