// Splits from the root down, for the builders without Morton codes: kernels/bvh/sbvh.cl.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// Splits nodes from the root down, and triangles if that pays. Keeps its scratch memory for repeated builds.
class Sbvh {
public:
    Sbvh() = default;
    /// Room for `count` triangles and `budget` times as many further references.
    Sbvh(const Device& device, std::uint32_t count, double budget);

    /// Largest number of references.
    [[nodiscard]] std::uint32_t capacity() const { return count_ + budget_; }
    /// Builds a tree whose leaves are references, in no particular order; `header` becomes its header. bounds.cl must
    /// have computed the bounds of all triangles before. Waits for the device.
    void build(const TriangleBuffers& triangles, const Buffer<std::uint32_t>& bound_keys, const Buffer<BvhNode>& nodes,
               const Buffer<LeafTriangle>& leaves, const Buffer<BvhHeader>& header);

private:
    struct Queue {
        Buffer<std::uint32_t> tasks[2];  // of this level and of the next, alternating
        Kernel split;
        std::uint32_t group = 0;
    };
    void split_level(const TriangleBuffers& triangles, const Buffer<std::uint32_t>& bound_keys,
                     const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves, std::uint32_t level,
                     const std::uint32_t waiting[2]);

    std::uint32_t count_ = 0, budget_ = 0, tiles_ = 0;
    Buffer<float> references_[2];
    Buffer<std::uint32_t> tile_sums_, counters_, small_;
    Queue queues_[2];  // of large and of medium nodes
    Kernel count_references_, scan_, place_, begin_, finish_subtrees_, finish_;
};

}  // namespace claray
