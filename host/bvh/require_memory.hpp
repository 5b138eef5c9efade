// Checks, before a build begins, that the device has enough memory.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// Elements of TriangleBuffers.
struct TriangleCounts {
    std::uint64_t positions = 0, indices = 0, geometries = 0, masks = 0;
};
[[nodiscard]] TriangleBuffers allocate_triangles(const Device& device, const TriangleCounts& counts);

/// Throws ErrorKind::device if the device lacks memory for all buffers of the build together, or refuses the largest
/// one. The message states the bytes needed and available, both including the triangles, and a configuration that fits,
/// if there is one.
void require_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config);
void require_memory(const Device& device, std::span<const Mesh> meshes, const Bvh::Config& config);
void require_memory(const Device& device, const TriangleBuffers& triangles, const Bvh::Config& config);

}  // namespace claray
