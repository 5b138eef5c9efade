// A binary tree built by the host: worse and slower to build than the device's, but without kernels to compile. Used
// for the first picture.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

struct HostTree {
    std::vector<BvhNode> nodes;        // node i lies between leaves i and i + 1
    std::vector<LeafTriangle> leaves;  // of the valid triangles
    BvhHeader header{};
};

/// Builds by median splits along the longest axis of the centroids' box, which gives the lowest possible tree for any
/// triangles.
[[nodiscard]] HostTree build_host_tree(std::span<const Mesh> meshes);

/// Builds so, always in the binary layout. A later `rebuild` builds on the device with Builder::fast.
[[nodiscard]] Bvh build_by_host(const Device& device, std::span<const Mesh> meshes, const Bvh::Config& config);
/// Uses a tree that was built elsewhere, in any layout. For comparing builders.
[[nodiscard]] Bvh bvh_of(const Device& device, std::span<const Mesh> meshes, const HostTree& tree,
                         const Bvh::Config& config);

}  // namespace claray
