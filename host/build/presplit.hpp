// Splits large triangles into several references: kernels/build/presplit.cl.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

/// References of the triangles of one structure, and the scratch memory to make them again and again.
class Presplit {
public:
    Presplit() = default;
    /// Room for `count` triangles and `budget` times as many further references.
    Presplit(const Device& device, std::uint32_t count, double budget, unsigned code_bits);

    /// References and codes, the most there can be.
    [[nodiscard]] std::uint32_t capacity() const { return count_ + budget_; }
    /// After bounds.cl has laid its grid over the whole boxes of all triangles: makes references and their codes.
    /// Returns how many codes there are to sort; waits for the device.
    template <class Code>
    [[nodiscard]] std::uint32_t split(const TriangleBuffers& triangles, const Buffer<BvhHeader>& header,
                                      const Buffer<std::uint32_t>& bound_keys, const Buffer<Code>& codes);
    /// The references in the order of their sorted codes, as leaves and clusters; `header.valid` becomes their number.
    void gather(const Buffer<std::uint32_t>& order, const Buffer<LeafTriangle>& leaves,
                const Buffer<std::uint32_t>& clusters, const Buffer<BvhHeader>& header);

private:
    std::uint32_t count_ = 0, budget_ = 0, limit_ = 0, tiles_ = 0, to_sort_ = 0;
    Buffer<float> priorities_;
    Buffer<std::uint32_t> plan_, tile_sums_;
    Buffer<LeafTriangle> references_;
    Kernel find_priorities_, count_splits_, choose_, sum_, scan_, place_, gather_;
};

}  // namespace claray
