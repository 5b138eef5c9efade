// EXT_mesh_gpu_instancing: a node that shows its mesh many times.
#pragma once

#include "host/io/gltf/gltf_nodes.hpp"

namespace claray {

/// The transforms of the node's mesh to the world: one, or as many as the extension says.
[[nodiscard]] std::vector<glm::dmat4> placements_of(const GltfFile& file, const PlacedNode& node);

}  // namespace claray
