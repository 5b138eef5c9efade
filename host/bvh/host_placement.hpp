// Places instances on the host, for a top level built by the host: see host_tree.hpp.
#pragma once

#include <span>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/bvh_node.h"
#include "claray/shared/instance.h"

namespace claray {

struct HostPlacement {
    std::vector<PlacedInstance> placed;
    Mesh boxes;                          // one triangle per instance that spans its box
    std::vector<MovingInstance> moving;  ///< empty if nothing can move
    float widening = 0;
};

/// As the kernel place_instances of kernels/bvh/instances.cl. Without `ends` nothing moves.
[[nodiscard]] HostPlacement place_by_host(std::span<const Instance> instances, std::span<const Instance> ends,
                                          std::span<const BvhHeader> bottoms);

}  // namespace claray
