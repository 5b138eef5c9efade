// Copies a binary tree into the order of its traversal: kernels/bvh/layout.cl.
#pragma once

#include "claray/bvh.hpp"
#include "host/compute/programs/kernel_set.hpp"

namespace claray {

class TreeLayout {
public:
    TreeLayout() = default;
    /// For trees of at most `capacity` leaves, each a reference to a triangle.
    TreeLayout(const Device& device, std::uint32_t capacity, unsigned max_leaf);
    [[nodiscard]] static KernelsOf<TreeLayout> kernels(unsigned max_leaf);

    /// Copies the triangles of the first `leaf_count` leaves and the tree over them. Asynchronous.
    void copy(const TriangleBuffers& triangles, const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves,
              std::uint32_t leaf_count, Buffer<std::uint32_t>& arrivals, const Buffer<BvhHeader>& header,
              const Buffer<BvhNode>& new_nodes, const Buffer<LeafTriangle>& new_leaves);

    [[nodiscard]] std::uint64_t bytes() const { return subtrees_.bytes(); }

private:
    Buffer<std::uint32_t> subtrees_;  // nine words each
    Kernel measure_, copy_, finish_;
};

}  // namespace claray
