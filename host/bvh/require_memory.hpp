// Is there memory enough for a build? Asked before it begins.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// Elements of TriangleBuffers.
struct TriangleCounts {
    std::uint64_t positions = 0, indices = 0, geometries = 0, masks = 0;
};
[[nodiscard]] TriangleBuffers allocate_triangles(const Device& device, const TriangleCounts& counts);

/// Throws ErrorKind::device with the bytes needed and available, and a choice that fits where there is one, unless the
/// device has memory for all buffers of the build together, and gives the largest of them. The first two count the
/// triangles' own buffers too.
void require_memory(const Device& device, const TriangleCounts& counts, const Bvh::Config& config);
void require_memory(const Device& device, std::span<const Mesh> meshes, const Bvh::Config& config);
void require_memory(const Device& device, const TriangleBuffers& triangles, const Bvh::Config& config);

}  // namespace claray
