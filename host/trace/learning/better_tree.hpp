// Builds a better tree over the triangles of another.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// The triangles that a tree holds, whatever its position buffer holds meanwhile.
struct HeldTriangles {
    std::vector<LeafTriangle> leaves;  ///< of a triangle that was split, several
    std::size_t count = 0;             ///< of the input; triangles that were culled are in no leaf
    std::size_t geometries = 0;        ///< with a mask; 0: no masks
    bool has_geometries = false;
};

/// Reads them by the queue of `queue`. Blocks.
[[nodiscard]] HeldTriangles read_triangles(const Device& queue, const Bvh& bvh);

/// Returns the seconds that a build by Builder::high takes: by the model of the device (plan/model in
/// kernels/tuning.txt) or, if it has none, 1 us for each triangle.
[[nodiscard]] double seconds_to_build_best(const Device& device, std::size_t triangles);

/// Builds by Builder::high, with the other settings and the layout of `config`. Keeps only what queries read. Blocks.
/// Throws ErrorKind::device if the build would take more than half of the memory that is left.
[[nodiscard]] Bvh build_best(const Device& queue, HeldTriangles triangles, Bvh::Config config);

}  // namespace claray
