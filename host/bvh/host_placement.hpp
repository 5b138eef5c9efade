// Instances placed by the host, for a top level that the host builds: see host_tree.hpp.
#pragma once

#include <span>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/bvh_node.h"
#include "claray/shared/instance.h"

namespace claray {

struct HostPlacement {
    std::vector<PlacedInstance> placed;
    Mesh boxes;                          // a triangle each that spans the box of an instance
    std::vector<MovingInstance> moving;  ///< empty where nothing can move
    float widening = 0;
};

/// The kernel place_instances of kernels/bvh/instances.cl. Without `ends` nothing moves.
[[nodiscard]] HostPlacement place_by_host(std::span<const Instance> instances, std::span<const Instance> ends,
                                          std::span<const BvhHeader> bottoms);

}  // namespace claray
