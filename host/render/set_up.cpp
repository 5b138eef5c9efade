// Makes a renderer: checks what it is asked for, plans its kernels, and builds the tree and the buffers of the scene.
#include <chrono>
#include <limits>
#include <memory>
#include <optional>

#include "host/base/file.hpp"
#include "host/base/seconds_since.hpp"
#include "host/compute/programs/compiler_processes.hpp"
#include "host/effects/effects.hpp"
#include "host/render/config/checks.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

constexpr std::size_t most_triangles_by_host = 1u << 20;
constexpr std::uint32_t quick_first_paths = 2048;  // in the batch that produces the first pixel

const Scene& checked(const Scene& scene) {
    validate(scene);
    return scene;
}

RenderConfig with_builder(RenderConfig config, const Device& device, const Scene& scene) {
    config.bvh.builder = builder_for(config.bvh.builder, device, !scene.instances.empty());
    return config;
}

FrameData frame_data(const Scene& scene, const Camera& camera, const SceneBuffers& buffers,
                     const RenderConfig& config) {
    FrameData frame = frame_without_camera(scene, buffers, config);
    frame.camera = camera_data(camera, aspect_of(config));
    return frame;
}

/// Device time of everything but copies between host and device.
double kernel_milliseconds(const Device& device) {
    double total = 0;
    for (const auto& [name, summary] : device.profiler().summary())
        if (name != "write_buffer" && name != "read_buffer" && name != "map_buffer") total += summary.milliseconds;
    return total;
}

/// Returns whether the host can build the first tree in less time than compiling the builder takes.
bool host_builds(const Device& device, const Scene& scene) {
    std::size_t triangles = scene.instances.size();
    for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
    return triangles <= most_triangles_by_host && (scene.instances.empty() || device.info().fp64);
}

/// A tree of trees is replaced only if the host built it, and trees in parts never. Quick kernels know no primitives.
KernelPlan plan_for(const Device& device, const Scene& scene, const RenderConfig& config, unsigned parts) {
    SceneTraits traits = traits_of(scene);
    traits.is_split = parts > 1;
    KernelPlan plan = plan_kernels(device, traits, config);
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

/// The programs of all kernels are loaded at once. Adds the device time to `milliseconds`.
Structure first_structure(const Device& device, const Scene& scene, std::size_t baked, const KernelPlan& plan,
                          const Bvh::Config& config, unsigned parts, double& milliseconds) {
    load(device, plan.first.programs);
    milliseconds -= kernel_milliseconds(device);
    const bool by_host =
        plan.start == KernelStart::quick && plan.first.layout == Layout::binary && host_builds(device, scene);
    Structure structure(device, scene, baked, with_layout(config, plan.first.layout), by_host, parts);
    milliseconds += kernel_milliseconds(device);
    return structure;
}

}  // namespace

LightSelection selection_of_lights(const RenderConfig& config) {
    LightSelection selection;
    if (config.approximate.tile_sum) selection.for_a_tree = std::numeric_limits<std::size_t>::max();
    if (config.approximate.tile_sum || config.effects.remove.has(Effect::light_lists)) selection.most_per_cell = 0;
    selection.compensates = !config.approximate.no_shadows && !config.approximate.light_grid;
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

Renderer::State::State(const Device& on, const Scene& scene, const RenderConfig& with, std::size_t baked) try
    : device(on),
      config(with_builder(checked(with), on, scene)),
      time{.set_up = Clock::now(), .set_up_processor = processor_seconds()},
      source{.camera = camera_of(scene, aspect_of(with)), .parts = parts_of(on, checked(scene), config)},
      kernels{.plan = plan_for(on, scene, config, source.parts), .patience = path_kernel_patience(on)},
      light_grid(light_grid_of(with, scene)),
      buffers(on, scene, first_structure(on, scene, baked, kernels.plan, config.bvh, source.parts, time.build),
              config.effects.add, selection_of_lights(with), words_of(light_grid), words_of_listed_pixels(),
              words_of_guide()),
      wavefront(buffers, frame_data(scene, source.camera, buffers, with), load_kernels(kernels.plan.first.effects),
                std::uint64_t(pixels()) * with.spp),
      film(on, pixels(), with.sample_clamp),
      sampling{
          .schedule = new_schedule(), .pace = Pace(first_paths(), wavefront.queues.capacity), .most_spp = with.spp} {
    for (const char* name : {trace_camera_name, trace_bounce_name, trace_shadow_name, trace_paths_name})
        time.of_kernels[name] = device.profiler().milliseconds(name);
    if (light_layers_of(with) > 0) outputs.light_layers.emplace(scene, with, wavefront);
    forget_slow_programs(on);
} catch (...) {
    forget_slow_programs(on);
}

bool Renderer::State::parts_take_turns() const {
    return buffers.structure.parts() && buffers.structure.parts()->take_turns();
}

std::uint32_t Renderer::State::first_paths() const {
    if (parts_take_turns()) return wavefront.queues.capacity;
    const std::uint32_t tuned = device.tuning("render/wavefront", "FIRST_PATHS");
    return kernels.plan.start == KernelStart::quick ? std::min(tuned, quick_first_paths) : tuned;
}

Renderer::Renderer(const Device& device, const Scene& scene, const RenderConfig& config) {
    const KeepCompilers keep;  // for the kernels of the tree and those of the paths
    const auto made_for = [&](const Scene& wanted) {
        if (wanted.instances.empty()) {
            auto state = std::make_shared<State>(device, wanted, config);
            state->source.shape = SceneShape(wanted, wanted, {}, {});
            return state;
        }
        PlacedScene placed = place_instances(checked(wanted));
        auto state = std::make_shared<State>(device, placed.scene, config, placed.baked);
        state->source.shape = SceneShape(wanted, placed.scene, std::move(placed.places), std::move(placed.numbers));
        return state;
    };
    RenderIdentity identity;
    std::optional<Checkpoint> from;  // read before the structure is built
    const bool resumes = !config.resume.empty(), saves = !config.checkpoint.empty();
    if (resumes || saves) identity = identity_of(checked(scene), checked(config));
    if (resumes) from = read_checkpoint(config.resume, identity, config.spp);
    if (saves) check_file_writable(config.checkpoint);
    const std::optional<Scene> changed = prepared_for_effects(checked(scene));
    const Scene& prepared = changed ? *changed : scene;
    state_ =
        config.effects.remove.empty() ? made_for(prepared) : made_for(without_effects(prepared, config.effects.remove));
    state_->list_region();
    if (config.alpha) state_->outputs.matte.emplace(device, prepared, config);
    state_->set_bounds(scene, true);
    state_->outputs.checkpoints.identity = identity;
    if (!from) return;
    if (!state_->sampling.schedule.go_to(from->position))
        throw Error(ErrorKind::user,
                    "cannot continue from '" + config.resume.string() +
                        "': the file is damaged: its position is outside the image",
                    "render from the start");
    state_->list_pixels();
    state_->error.progress = from->error;
    state_->film.set_sums(from->sums);
}

}  // namespace claray
