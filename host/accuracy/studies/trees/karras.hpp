// The linear BVH by Karras' parallel splits: kernels/accuracy/karras.cl.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// Morton codes of 63 bits, sorted, as Builder::fast has them before it builds its tree.
struct SortedTriangles {
    TriangleBuffers triangles;
    Buffer<std::uint64_t> codes;
    Buffer<std::uint32_t> order;  ///< of the triangles, culled ones last
    Buffer<BvhHeader> header;     ///< counts only, until a tree is built
};
[[nodiscard]] SortedTriangles sort_triangles(const Device& device, const TriangleBuffers& triangles);

/// A tree in the binary layout, with leaves of up to `max_leaf` triangles.
class KarrasTree {
public:
    KarrasTree(const Device& device, const SortedTriangles& sorted, unsigned max_leaf);

    /// Asynchronous.
    void build();

    [[nodiscard]] const Buffer<BvhHeader>& header() const { return sorted_.header; }
    [[nodiscard]] const Buffer<BvhNode>& nodes() const { return nodes_; }
    [[nodiscard]] const Buffer<LeafTriangle>& leaves() const { return leaves_; }

private:
    SortedTriangles sorted_;
    Buffer<std::uint32_t> splits_, parents_, arrivals_;
    Buffer<BvhNode> nodes_;
    Buffer<LeafTriangle> leaves_;
    Kernel find_splits_, fit_boxes_;
};

}  // namespace claray
