// Counts the rays that a wavefront traces.
#pragma once

#include "host/compute/memory.hpp"

namespace claray {

/// The host counts camera rays, the device all others (render/queues/empty_queues.cl).
struct RayTotals {
    explicit RayTotals(const Device& device) : of_stages(device, 2), of_paths(device, 2) { reset(); }

    struct Sums {
        std::uint64_t camera = 0, bounce = 0, shadow = 0;
        std::uint64_t in_paths = 0;  // of these, the rays traced by the kernel of whole paths
    };
    /// Rays traced so far. Blocks.
    [[nodiscard]] Sums sums() const {
        const std::vector<std::uint64_t> stages = of_stages.read(), paths = of_paths.read();
        return {camera + camera_in_paths, stages[0] - camera + paths[0], stages[1] + paths[1],
                camera_in_paths + paths[0] + paths[1]};
    }
    /// Asynchronous.
    void reset() {
        camera = camera_in_paths = 0;
        of_stages.fill(0), of_paths.fill(0);
    }
    /// What was counted so far. Blocks.
    struct Counts {
        std::uint64_t camera, camera_in_paths;
        std::vector<std::uint64_t> of_stages, of_paths;
    };
    [[nodiscard]] Counts counts() const { return {camera, camera_in_paths, of_stages.read(), of_paths.read()}; }
    /// Forgets what was counted since `counts`.
    void restore(const Counts& counts) {
        camera = counts.camera, camera_in_paths = counts.camera_in_paths;
        of_stages.write(std::span(counts.of_stages)), of_paths.write(std::span(counts.of_paths));
    }
    [[nodiscard]] std::uint64_t bytes() const { return buffer_bytes(of_stages, of_paths); }

    std::uint64_t camera = 0, camera_in_paths = 0;
    Buffer<std::uint64_t> of_stages, of_paths;  // in queues; only those of stages include camera rays
};

}  // namespace claray
