// A binary tree that the host builds: worse and slower than the device's, but there is nothing to compile for it. A
// first picture is traced through it.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

struct HostTree {
    std::vector<BvhNode> nodes;        // node i lies between leaves i and i + 1
    std::vector<LeafTriangle> leaves;  // of the valid triangles
    BvhHeader header{};
};

/// Median splits along the longest axis of the centroids' box: as low as a tree can be, whatever the triangles are.
[[nodiscard]] HostTree build_host_tree(std::span<const Mesh> meshes);

}  // namespace claray
