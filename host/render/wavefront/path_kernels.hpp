// Kernels that follow paths in place of the stages: whole ones (render/trace_paths.cl), or the last of a batch
// (render/finish_paths.cl). The radiance is the same bit for bit.
#pragma once

#include <cstdint>
#include <optional>

#include "host/render/scene_buffers.hpp"
#include "host/render/wavefront/ray_totals.hpp"

namespace claray {

struct PathKernels {
    explicit PathKernels(const Device& device);

    /// From the next batch on. The kernel's name tells what it follows.
    void add(const Kernel& kernel);
    void drop() { whole.reset(), last.reset(); }
    /// Returns whether a batch of so many paths is too small to keep the device busy to the end of each stage.
    [[nodiscard]] bool is_small(std::uint64_t paths) const { return paths <= most_whole; }

    std::optional<Kernel> whole, last;
    std::uint64_t most_whole, most_last;  // paths that each follows at once
};

/// Returns whether the kernel of whole paths may pay: the device is suitable and the effects are few.
[[nodiscard]] bool may_follow_paths(const SceneBuffers& scene, EffectSet effects);
/// Returns whether these rays' paths are so short that work-items that each trace a whole path would seldom wait for
/// each other.
[[nodiscard]] bool paths_are_short(const Device& device, const RayTotals::Sums& rays);
/// Returns whether the kernel that follows the last paths may pay.
[[nodiscard]] bool may_finish_paths(const SceneBuffers& scene, EffectSet effects);
/// Approximate time to compile either, in seconds.
[[nodiscard]] double path_kernel_patience(const Device& device);
/// Work-items of a group.
[[nodiscard]] unsigned path_kernel_group(const Device& device);

}  // namespace claray
