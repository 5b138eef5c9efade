// Splits from the root down, for the builders without Morton codes: kernels/bvh/sbvh.cl.
#pragma once

#include "claray/bvh.hpp"
#include "host/compute/programs/kernel_set.hpp"

namespace claray {

/// Splits nodes from the root down, and triangles if that pays. Keeps its scratch memory for repeated builds.
class Sbvh {
public:
    Sbvh() = default;
    /// Room for `count` triangles and `budget` times as many further references. `leaf_block`: see sbvh_serial.cl.
    Sbvh(const Device& device, std::uint32_t count, double budget, unsigned leaf_block = 1);
    [[nodiscard]] static KernelsOf<Sbvh> kernels(const Device& device, unsigned leaf_block);

    /// Largest number of references.
    [[nodiscard]] std::uint32_t capacity() const { return count_ + budget_; }
    /// Builds a tree whose leaves are references, in no particular order; `header` becomes its header. Waits for the
    /// device.
    void build(const TriangleBuffers& triangles, const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves,
               const Buffer<BvhHeader>& header);

    [[nodiscard]] std::uint64_t bytes() const;

private:
    struct Queue {
        Buffer<std::uint32_t> tasks[2];  // of this level and of the next, alternating
    };
    void split_large(const TriangleBuffers& triangles, std::uint32_t level, std::uint32_t waiting,
                     std::uint32_t chunk_count);
    void split_medium(const TriangleBuffers& triangles, const Buffer<BvhNode>& nodes,
                      const Buffer<LeafTriangle>& leaves, std::uint32_t level, std::uint32_t waiting);
    void finish_subtrees(const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves);

    std::uint32_t count_ = 0, budget_ = 0, chunk_ = 0, large_group_ = 0, medium_group_ = 0, runs_ = 0;
    Buffer<float> references_[2];
    Buffer<std::uint32_t> root_extent_, counters_, small_;
    Queue large_, medium_;
    Buffer<std::uint32_t> states_, bins_, chunks_;  // of large nodes
    Kernel begin_placing_, place_, begin_, split_, finish_subtrees_, finish_;
    Kernel begin_large_, bin_large_, choose_large_, reserve_large_, move_large_, finish_large_;
};

}  // namespace claray
