// Makes a binary tree better by moving its nodes: kernels/bvh/reinsertion.cl.
#pragma once

#include "claray/bvh.hpp"

namespace claray {

class Reinsertion {
public:
    Reinsertion() = default;
    /// For trees of at most `leaves` leaves.
    Reinsertion(const Device& device, std::uint32_t leaves);

    /// `rounds` rounds of moves; a node searches for a better place in every `stride`th. Enqueued only.
    void run(const Buffer<BvhNode>& nodes, Buffer<std::uint32_t>& arrivals, const Buffer<BvhHeader>& header,
             unsigned rounds, unsigned stride);

private:
    std::uint32_t leaves_ = 0;
    Buffer<std::uint32_t> leaf_parents_, gains_, owners_;
    Buffer<std::uint32_t> moves_;  // four words each
    Kernel find_leaf_parents_, find_moves_, claim_by_gain_, claim_by_id_, find_winners_, prevent_cycles_, apply_,
        update_;
};

}  // namespace claray
