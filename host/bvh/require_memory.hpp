// Checks, before a build begins, that the device has enough memory.
#pragma once

#include <functional>

#include "claray/bvh.hpp"

namespace claray {

/// Elements of TriangleBuffers.
struct TriangleCounts {
    std::uint64_t positions = 0, indices = 0, geometries = 0, masks = 0;
};
[[nodiscard]] TriangleCounts counts_of(std::span<const Mesh> meshes);
[[nodiscard]] TriangleCounts counts_of(const TriangleBuffers& triangles);
[[nodiscard]] TriangleBuffers allocate_triangles(const Device& device, const TriangleCounts& counts);

/// What a build takes, with the triangles.
[[nodiscard]] BvhMemory memory_needed(const Device& device, const TriangleCounts& counts, const Bvh::Config& config);

/// Throws ErrorKind::device if the device lacks memory for all buffers of the build together, or refuses the largest
/// one. The message states the bytes needed and available, both including the triangles, and a configuration that fits,
/// if there is one.
void require_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config);
/// For triangles that are on the device.
void require_memory(const Device& device, const TriangleBuffers& triangles, const Bvh::Config& config);

/// Calls `allocate`, which allocates all that a build of these triangles takes. If the driver refuses some of it, since
/// other programs use the memory, throws as require_memory does, and names a configuration that takes less.
void commit_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config,
                   const std::function<void()>& allocate);

}  // namespace claray
