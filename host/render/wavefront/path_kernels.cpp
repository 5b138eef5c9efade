#include "host/render/wavefront/path_kernels.hpp"

#include "host/render/kernels/stage_kernels.hpp"

namespace claray {
namespace {

constexpr const char* stem = "render/trace_paths";

std::uint64_t most_paths(const Device& device, const char* kernel) {
    return std::uint64_t(device.info().compute_units) * device.tuning(kernel, "MOST_PATHS_PER_UNIT");
}

}  // namespace

PathKernels::PathKernels(const Device& device)
    : most_whole(most_paths(device, stem)), most_last(most_paths(device, "render/finish_paths")) {}

void PathKernels::add(const Kernel& kernel) { (kernel.name() == trace_paths_name ? whole : last) = kernel; }

bool may_follow_paths(const SceneBuffers& scene, EffectSet effects) {
    const Structure& structure = scene.structure;
    if (!structure.is_one_binary_tree()) return false;
    return number_of(of_stage(effects, Stage::shade)) <= structure.device().tuning(stem, "MOST_EFFECTS");
}

bool paths_are_short(const Device& device, const RayTotals::Sums& rays) {
    const double most = device.tuning(stem, "MOST_BOUNCES_PERMILLE") * 1e-3;
    return double(rays.bounce) <= most * double(rays.camera);
}

bool may_finish_paths(const SceneBuffers& scene, EffectSet effects) {
    return may_follow_paths(scene, effects) && PathKernels(scene.structure.device()).most_last > 0;
}

double path_kernel_patience(const Device& device) { return device.tuning(stem, "PATIENCE_MILLISECONDS") * 1e-3; }

unsigned path_kernel_group(const Device& device) { return device.tuning(stem, "GROUP_SIZE"); }

}  // namespace claray
