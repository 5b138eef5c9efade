// Builds a better tree over the triangles of another.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// The triangles that the tree holds now, whatever `bvh.triangles()` holds meanwhile. Those that were culled are NaN.
/// Read by the queue of `queue`. Blocks.
[[nodiscard]] TriangleBuffers triangles_held(const Device& queue, const Bvh& bvh);

/// The seconds that a build by Builder::high takes, by the model of the device (plan/model in kernels/tuning.txt).
/// Infinite if the device has no model.
[[nodiscard]] double seconds_to_build_best(const Device& device, std::size_t triangles);

/// Builds by Builder::high, in the layout of `bvh`. Keeps only what queries read. Blocks.
[[nodiscard]] Bvh build_best(const Device& queue, const Bvh& bvh, const TriangleBuffers& triangles);

}  // namespace claray
