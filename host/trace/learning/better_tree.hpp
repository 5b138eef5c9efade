// Builds a better tree over the triangles of another, and compares them.
#pragma once

#include "host/trace/learning/ray_sample.hpp"

namespace claray {

/// Seconds of tracing a ray of the sample, on the queue of `queue`. Blocks.
[[nodiscard]] double seconds_per_ray(const Device& queue, const Bvh& bvh, const std::vector<RaySample::Piece>& sample);

/// The triangles that the tree holds now, whatever `bvh.triangles()` holds meanwhile. Those that were culled are NaN.
/// Blocks.
[[nodiscard]] TriangleBuffers triangles_held(const Device& queue, const Bvh& bvh);

/// The seconds that a build by Builder::high takes, by the model of the device (plan/model in kernels/tuning.txt).
/// Infinite if the device has no model.
[[nodiscard]] double seconds_to_build_best(const Device& device, std::size_t triangles);

/// Builds by Builder::high, in the layout of `bvh`. Keeps only what queries read. Blocks.
[[nodiscard]] Bvh build_best(const Device& queue, const Bvh& bvh, const TriangleBuffers& triangles);

/// Whether the rays are faster with `other`: by the median of several turns. Blocks. Ends early, and returns false, if
/// `stop` returns true.
[[nodiscard]] bool is_faster(const Device& queue, const Bvh& bvh, const Bvh& other,
                             const std::vector<RaySample::Piece>& sample, const std::function<bool()>& stop);

}  // namespace claray
