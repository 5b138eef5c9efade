#include "host/render/wavefront/wavefront.hpp"

#include <algorithm>
#include <tuple>

#include "claray/shared/lists/lobes.h"

namespace claray {
namespace {

/// Consecutive paths that an item of shade_surface works on.
std::uint32_t paths_per_item(const Device& device) {
    if (device.info().type != DeviceType::cpu) return 1;
    return std::max(1u, device.tuning("render/shade_surface", "PATHS_PER_ITEM"));
}

}  // namespace

SkyData sky_data(const Scene& scene) {
    Sky sky = scene.sky;
    if (!scene.environment.images.empty()) sky.horizon = sky.zenith = glm::vec3(0.f);
    SkyData data{};
#define CLARAY_COLOR(name, text) data.name##_r = sky.name.x, data.name##_g = sky.name.y, data.name##_b = sky.name.z;
#define CLARAY_NUMBER(name, text) data.name = sky.name;
    CLARAY_SKY(CLARAY_COLOR, CLARAY_NUMBER)
#undef CLARAY_COLOR
#undef CLARAY_NUMBER
    return data;
}

Wavefront::Wavefront(const SceneBuffers& on, const FrameData& of, WavefrontKernels with, std::uint64_t most_paths)
    : scene(on),
      frame(of),
      kernels(std::move(with)),
      queues(on, kernels.config, most_paths),
      totals(on.structure.device()),
      path_kernels(on.structure.device()) {
    const Device& device = on.structure.device();
    bounces_per_look_ = std::max(1u, device.tuning("render/wavefront", "BOUNCES_PER_LOOK"));
    shade_group_ = device.tuning("render/shade_surface", "GROUP_SIZE");
    paths_per_item_ = paths_per_item(device);
    frame.tables = scene.where;
}

std::size_t Wavefront::floats_per_path() const {
    const unsigned layers = kernels.config.light_layers;
    if (layers > 0) return CLARAY_FLOATS_BEFORE_LAYERS + floats_of_layers(layers);
    return floats_of_paths(scene.where) + (frame.guide.lessons != 0 ? 3 * CLARAY_GUIDE_LESSONS : 0);
}

void Wavefront::make_room(std::uint32_t paths) { queues.make_room(paths, scene, kernels.config, floats_per_path()); }

Step Wavefront::step_of(const Batch& batch, std::uint32_t depth, std::uint32_t limit) const {
    return {batch, frame, depth, limit, queues.room(), waves()};
}

void Wavefront::resize(std::uint32_t width, std::uint32_t height, std::uint64_t most_paths) {
    frame.width = width, frame.height = height;
    queues.limit(scene, kernels.config, most_paths);
}

void Wavefront::take_over(const Structure& structure, WavefrontKernels with) {
    scene.structure = structure;
    if (with.config.shaders.size() > kernels.config.shaders.size()) queues.outdate();  // room for the lists
    kernels = std::move(with);
    path_kernels.drop();
}

/// Which buffers there are depends on lights, a light tree, instances and motion.
void Wavefront::replace_scene(const SceneBuffers& by) {
    const auto needs = [](const SceneBuffers& of) {
        return std::tuple(has_lights(of.lights), of.where.light_tree != CLARAY_NO_TABLE,
                          of.structure.instanced().has_value(), of.structure.moves());
    };
    if (needs(by) != needs(scene)) queues.outdate();
    scene = by;
    frame.lights = scene.lights, frame.tables = scene.where;
}

void Wavefront::generate(const Batch& batch, bool centers, const Buffer<float>& radiance) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    const bool cpu = scene.structure.device().info().type == DeviceType::cpu;
    const RayArrays& first = queues.of_depth(0);
    queues.lengths.of_rays(0).fill(paths);
    kernels.generate.run({cpu ? (paths + 15) / 16 : paths, 64}, batch, frame, std::uint32_t(centers), scene.tables,
                         first.rays, first.states, arg("radiance", radiance), arg("times", first.times));
}

void Wavefront::trace(const Batch& batch) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    make_room(paths);
    if (path_kernels.whole && !is_guided() && path_kernels.is_small(paths)) return trace_paths(batch);
    generate(batch, false);
    kernels.tile_sum ? sum_tiles(batch) : trace_stages(batch, false);
}

/// Camera rays only.
void Wavefront::sum_tiles(const Batch& batch) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    const RayArrays& first = queues.of_depth(0);
    totals.camera += paths;
    kernels.trace_camera.closest(first.rays, queues.hits, paths, queues.lengths.of_rays(0), first.times);
    kernels.tile_sum->run(step_of(batch, 0, paths), scene, first.rays, first.queue, queues.hits, queues.radiance);
    empty_queues();
}

/// After its last scattering a path may still meet a light or the sky.
std::uint32_t Wavefront::waves() const {
    const bool one_more = !(scene.effects & effects_with(CLARAY_EMITS)).empty() && frame.max_depth != ~std::uint32_t(0);
    return frame.max_depth + (one_more ? 1 : 0);
}

void Wavefront::trace_paths(const Batch& batch) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    totals.camera_in_paths += paths;
    path_kernels.whole->run({paths, path_kernel_group(scene.structure.device())}, step_of(batch, waves(), paths),
                            scene.structure.bvh(), scene, arg("radiance", queues.radiance), queues.lengths.all);
    kernels.empty_queues.run({1, 1}, queues.lengths.all, totals.of_paths);
}

void Wavefront::trace_stages(const Batch& batch, bool arrived, std::uint32_t first_depth) {
    std::uint32_t limit = batch.pixels * batch.samples;
    totals.camera += limit;
    const std::uint32_t all = waves();
    for (std::uint32_t depth = first_depth; depth < all && limit != 0; ++depth) {
        bounce(batch, depth, limit, arrived && depth == 0);
        if (depth + 1 == all) break;
        const bool looks = scene.structure.parts() || (depth + 1) % bounces_per_look_ == 0;
        if (looks) limit = queues.lengths.of_rays(depth + 1).read()[0];
        if (path_kernels.last && !is_guided() && limit != 0 && limit <= path_kernels.most_last) {
            trace_last_paths(batch, depth + 1, limit);
            break;
        }
    }
    empty_queues();
}

void Wavefront::trace_last_paths(const Batch& batch, std::uint32_t depth, std::uint32_t limit) {
    path_kernels.last->run({limit, path_kernel_group(scene.structure.device())}, step_of(batch, depth, limit),
                           scene.structure.bvh(), scene, arg("queue", queues.of_depth(depth).queue),
                           arg("radiance", queues.radiance), queues.lengths.all, waves());
}

void Wavefront::bounce(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived) {
    scatter(batch, depth, limit, arrived, false);
    look_for_light(depth, limit);
}

void Wavefront::scatter(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived, bool always) {
    const RayArrays &in = queues.of_depth(depth), &out = queues.of_depth(depth + 1);
    SceneQuery& query = depth == 0 ? kernels.trace_camera : kernels.trace_bounce;
    if (!arrived) query.closest(in.rays, queues.hits, limit, queues.lengths.of_rays(depth), in.times);
    const std::uint32_t items = (limit + paths_per_item_ - 1) / paths_per_item_;
    Step step = step_of(batch, depth, limit);
    if (always) step.waves = ~std::uint32_t(0);
    const auto shade = [&](Kernel& kernel, const auto&... which) {
        kernel.run({items, shade_group_}, step, scene, queues.lengths.all, totals.of_stages, arg("queue", in.queue),
                   queues.hits, arg("next_queue", out.queue), queues.shadow.queue, arg("radiance", queues.radiance),
                   which...);
    };
    if (kernels.config.shaders.empty()) return shade(kernels.shade[0]);
    const auto sorted = arg("sorted", queues.sorted);
    kernels.sort.run({limit, 64}, step, scene, queues.lengths.all, queues.hits, sorted);
    for (std::uint32_t i = 0; i < kernels.shade.size(); ++i) shade(kernels.shade[i], sorted, i);
}

void Wavefront::look_for_light(std::uint32_t depth, std::uint32_t limit) {
    if (has_lights(scene.lights) && depth < frame.max_depth) trace_shadows(limit, queues.lengths.of_shadow_rays(depth));
}

void Wavefront::empty_queues() { kernels.empty_queues.run({1, 1}, queues.lengths.all, totals.of_stages); }

void Wavefront::trace_shadows(std::uint32_t limit, const Buffer<std::uint32_t>& length) {
    ShadowArrays& shadow = queues.shadow;
    if (kernels.adds_light) {
        kernels.trace_shadow.shadow(shadow.rays, {shadow.light, queues.radiance}, limit, length);
        return;
    }
    if (!kernels.config.approximate.no_shadows)
        kernels.trace_shadow.any(shadow.rays, shadow.occluded, limit, length, shadow.times);
    if (kernels.config.light_layers > 0)
        kernels.add_light.run({limit, 64}, length, limit, shadow.occluded, shadow.light, queues.radiance,
                              queues.room());
    else
        kernels.add_light.run({limit, 64}, length, limit, shadow.occluded, shadow.light, queues.radiance);
}

void Wavefront::trace_camera_rays(const Batch& batch, const Buffer<float>& room) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    make_room(paths);
    generate(batch, false, room);
    const RayArrays& first = queues.of_depth(0);
    kernels.trace_camera.closest(first.rays, queues.hits, paths, queues.lengths.of_rays(0), first.times);
    queues.lengths.of_rays(0).fill(0);
}

void Wavefront::trace_first_hits(const Batch& batch, SceneQuery& query, bool centers) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    make_room(paths);
    generate(batch, centers);
    const RayArrays& first = queues.of_depth(0);
    query.closest(first.rays, queues.hits, paths, queues.lengths.of_rays(0), first.times);
    queues.lengths.of_rays(0).fill(0);
}

}  // namespace claray
