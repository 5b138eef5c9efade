// Trees that divide space, not triangles: a k-d tree and an octree, built by the host for
// kernels/accuracy/trace_cells.cl.
#pragma once

#include <span>
#include <vector>

#include "claray/shared/bvh_node.h"
#include "claray/shared/study_nodes.h"

namespace claray {

/// A triangle is listed in every leaf whose cell it reaches. Without triangles there are no nodes.
struct CellTree {
    std::vector<CellNode> nodes;       ///< the root first; the children of a node follow each other
    std::vector<std::uint32_t> lists;  ///< indices of triangles, leaf after leaf
    unsigned height = 0;               ///< levels below the root
};

/// Halves cells along all axes while more than eight triangles reach them.
[[nodiscard]] CellTree build_octree(std::span<const LeafTriangle> triangles);

/// Cuts cells where the surface area heuristic is least (MacDonald and Booth 1990; parameters of Wald and Havran 2006,
/// "On building fast kd-Trees for Ray Tracing, and on doing that in O(N log N)").
[[nodiscard]] CellTree build_kd_tree(std::span<const LeafTriangle> triangles);

}  // namespace claray
