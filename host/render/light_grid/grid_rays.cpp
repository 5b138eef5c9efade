#include "host/render/light_grid/grid_rays.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr std::uint32_t probe_seed = 0x9e3779b9;
constexpr std::uint32_t most_surfaces_of_probes =
    5;  // of their rays' paths, which the grid nearly always ends at the first

/// Calls `visit` with batches of consecutive items of a box, with `samples` paths each. Their rays, of this depth, have
/// room and a length.
template <class Visit>
void for_each_batch(Wavefront& wavefront, const GridBox& box, std::uint32_t first_sample, std::uint32_t samples,
                    std::uint32_t depth, const Visit& visit) {
    const std::uint32_t all = box.width * box.height * box.depth;
    const std::uint32_t most = std::max(1u, std::min(light_grid_paths, wavefront.queues.capacity) / samples);
    for (std::uint32_t first = 0; first < all; first += most) {
        const Batch batch{first, std::min(most, all - first), first_sample, samples, 0};
        const std::uint32_t paths = batch.pixels * samples;
        wavefront.make_room(paths);
        wavefront.queues.lengths.of_rays(depth).fill(paths);
        visit(batch, paths, wavefront.step_of(batch, depth, paths));
    }
}

}  // namespace

void mark_cells(Wavefront& wavefront, const GridBox& cells) {
    LightGridKernels& grid = *wavefront.kernels.light_grid;
    const SceneBuffers& scene = wavefront.scene;
    Queues& queues = wavefront.queues;
    const auto trace = [&](const Batch& batch, std::uint32_t paths, const Step& step) {
        const RayArrays& first = queues.of_depth(0);
        Buffer<std::uint32_t>& length = queues.lengths.of_rays(0);
        grid.aim_cells.run({paths, 64}, step, cells, scene.tables, first.queue);
        wavefront.kernels.trace_bounce.closest(first.rays, queues.hits, paths, length, first.times);
        grid.mark_cells.run({batch.pixels * CLARAY_GRID_WORDS, 64}, step, cells, scene,
                            arg("grid_tables", scene.tables), first.queue, queues.hits);
        length.fill(0);
    };
    for_each_batch(wavefront, cells, 0, CLARAY_RAYS_PER_CELL, 0, trace);
}

/// The rays begin where a path would be that met one surface.
void gather_probes(Wavefront& wavefront, const GridBox& probes, const ProbeRays& rays) {
    LightGridKernels& grid = *wavefront.kernels.light_grid;
    const SceneBuffers& scene = wavefront.scene;
    Queues& queues = wavefront.queues;
    const bool cpu = scene.structure.device().info().type == DeviceType::cpu;
    const FrameData frame = wavefront.frame;
    wavefront.frame.seed = probe_seed, wavefront.frame.max_depth = most_surfaces_of_probes;
    const auto trace = [&](const Batch& batch, std::uint32_t paths, const Step& step) {
        grid.aim_probes.run(cpu ? Range{batch.pixels, 4} : Range{paths, 64}, step, probes, scene.tables,
                            queues.of_depth(1).queue, queues.radiance);
        wavefront.trace_stages(batch, false, 1);
        grid.gather_probes.run({batch.pixels, 64}, step, probes, rays.most_before, scene.tables, queues.radiance);
    };
    for_each_batch(wavefront, probes, rays.round * rays.per_probe, rays.per_probe, 1, trace);
    wavefront.frame = frame;
}

/// Only the light that arrives at the surfaces directly or from the grid.
void gather_voxels(Wavefront& wavefront, const GridBox& voxels, const ProbeRays& rays) {
    LightGridKernels& grid = *wavefront.kernels.light_grid;
    const SceneBuffers& scene = wavefront.scene;
    Queues& queues = wavefront.queues;
    const FrameData frame = wavefront.frame;
    wavefront.frame.seed = probe_seed + rays.round, wavefront.frame.max_depth = most_surfaces_of_probes;
    const auto trace = [&](const Batch& batch, std::uint32_t paths, const Step& step) {
        const RayArrays& first = queues.of_depth(1);
        grid.aim_voxels.run({paths, 64}, step, voxels, scene.tables, first.queue, queues.radiance);
        wavefront.bounce(batch, 1, paths, false);
        if (scene.effects.has(Effect::sky)) {  // which the surfaces look for by one more ray
            wavefront.bounce(batch, 2, paths, false);
            Buffer<std::uint32_t>& length = queues.lengths.of_rays(1);
            length.fill(paths);
            wavefront.kernels.trace_bounce.closest(first.rays, queues.hits, paths, length, first.times);
        }
        grid.gather_voxels.run({batch.pixels, 64}, step, voxels, rays.most_before, scene,
                               arg("grid_tables", scene.tables), first.queue, queues.hits,
                               arg("radiance", queues.radiance));
        wavefront.empty_queues();
    };
    for_each_batch(wavefront, voxels, 0, CLARAY_RAYS_PER_VOXEL, 1, trace);
    wavefront.frame = frame;
}

void show_voxels(Wavefront& wavefront, const Batch& batch, const Buffer<float>& albedo) {
    wavefront.trace_first_hits(batch, wavefront.kernels.trace_camera, true);
    wavefront.kernels.light_grid->show_voxels.run({batch.pixels, 64}, wavefront.step_of(batch, 0, batch.pixels),
                                                  wavefront.scene.tables, wavefront.queues.of_depth(0).rays,
                                                  wavefront.queues.hits, albedo);
}

}  // namespace claray
